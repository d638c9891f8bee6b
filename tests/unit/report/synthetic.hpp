// A slope that collapses, made up: enough like an experiment and its simulation to write reports of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

struct SyntheticOptions {
  double spacing_m = 0.0055;  // of the particles: about 2000
  int frames = 26;
  int width_px = 720, height_px = 540;
  bool measured = true, simulated = true, comparison = true, pictures = true, pairs = true, energy = true, reactions = false;
  double amplitude = 1;  // of the motion; 0: nothing moves
};

/// Owns what a Content refers to.
struct Synthetic {
  Content content;
  std::vector<Picture> pictures;
};

Synthetic make_synthetic(const SyntheticOptions& options);

}  // namespace pivnp::report

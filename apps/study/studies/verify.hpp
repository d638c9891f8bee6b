// `pivnp verify`: cases with known truth, held against it.
#pragma once

#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct VerifyResult {
  struct Item {
    std::string criterion;
    double limit = 0, reached = 0;
    bool passed = false;
  };
  std::string name;
  bool passed = false;
  double seconds = 0;
  std::vector<Item> items;
  std::string failure;  // why it could not be verified; empty otherwise
};

/// Runs a [synth] case through images and as nodal increments, and holds both against [verify].
VerifyResult verify_case(const Case& c, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

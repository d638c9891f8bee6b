// The vectors of one pair of frames, in pixels.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/record/vector_status.hpp"

namespace pivnp::piv {

/// Result of one pair, in pixels (column, row: row downward) at the lattice's nodes. Same arrays as VectorField.
struct PixelVectors {
  Anchor anchor = Anchor::central;
  std::vector<std::array<float, 2>> displacement;
  std::vector<VectorStatus> status;
  std::vector<std::array<float, 3>> cov;
  std::vector<float> score;
  float correlation_px = 0;  // distance within which errors of vectors are alike (half the width they average over)
  std::vector<float> path_factor = {};  // VectorField's; empty: 1
};

}  // namespace pivnp::piv

// Measured displacement increments of one pair of frames at the nodes of the grid.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/record/vector_status.hpp"

namespace pivnp {

/// One pair. Lengths in the record's unit, y upward. Arrays are [ny][nx] in the grid's node order.
struct VectorField {
  std::array<int, 2> pair{0, 1};  // frame indices
  Anchor anchor = Anchor::central;
  Grid grid;
  std::vector<std::array<float, 2>> displacement;
  std::vector<VectorStatus> status;
  std::vector<std::array<float, 3>> cov;  // random error (uu, vv, uv), length^2
  float correlation_length = 0;           // distance within which the errors of vectors are alike
  std::vector<float> score;               // correlation coefficient of the matched subset, -1 .. 1; NaN if failed
  // Of pairs that share errors: what this one adds to the covariance of a path from the first of them on, over cov. Empty: 1.
  std::vector<float> path_factor = {};
};

}  // namespace pivnp

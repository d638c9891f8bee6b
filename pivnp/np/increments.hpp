// Nodal displacement increments of one pair in double precision: analytic fields, and sources that know more digits
// than a measurement. (A measured VectorField is single precision: its rounding, 6e-8 of the increment, is far below
// any measurement but far above round-off, so exactness is proved with these.)
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::np {

struct NodalIncrements {
  Anchor anchor = Anchor::central;
  Grid grid;
  std::vector<std::array<double, 2>> displacement;  // [ny][nx], length
  std::vector<VectorStatus> status;                 // [ny][nx]
  std::vector<std::array<float, 3>> cov;            // [ny][nx] (uu, vv, uv), length^2; empty: not known
};

/// The same pair as a measurement would hold it (single precision; score 1 where usable, NaN elsewhere).
VectorField vector_field(const NodalIncrements& increments, std::array<int, 2> pair);

}  // namespace pivnp::np

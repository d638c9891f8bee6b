// Means of lattice values over their neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/spline_field.hpp"

namespace pivnp::piv {

/// Weights 1/4, 1/2, 1/4 along both axes (edges repeat); with the hats of the cells a window of about 26 px at 8 px
/// spacing.
void binomial_mean(const CellLattice& lattice, const std::vector<float>& in, std::vector<float>& out);

/// Even mean over (2 reach + 1)^2 points, fewer at the edges. Cost independent of the reach.
void box_mean(const CellLattice& lattice, const std::vector<float>& in, int reach, std::vector<float>& out);

/// Fills what is not `known` with a smooth continuation of what is: means over ever larger squares of known values (pull and push,
/// Gortler et al. 1996), then relaxed towards the mean of the four neighbours. Unchanged where nothing is known.
void continue_field(const CellLattice& lattice, const std::vector<std::uint8_t>& known, std::vector<float>& values);

}  // namespace pivnp::piv

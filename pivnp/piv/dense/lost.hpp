// What smoothing took off a measured field that was no noise.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/spline_field.hpp"

namespace pivnp::piv {

/// Square of the bias that smoothing leaves at each point of a lattice, 0 where none can be told from noise. `off`: the
/// values before smoothing minus those after it. Noise, as cells with hat weights show it (neighbours correlate by 1/4), has
/// no lasting sign along any line; a band whose waves were too short or too weak for shrinkage to keep has one along itself.
/// Of the means over lines of 9, 17 and 33 points (along both axes and both diagonals) the greatest counts where it exceeds
/// 3.5 standard errors, less the square of one; the noise is that of the differences along the line, over five lines side by
/// side. So less than one point in a hundred of a field of noise alone is given a bias. Points that are not `wanted` (empty:
/// all are) take no part. A bias that changes its sign within nine points is not seen.
/// Lines end at values off by more than 2 px, which are wrong matches.
void lost_variance(const CellLattice& lattice, const std::vector<float>& off, const std::vector<std::uint8_t>& wanted,
                   int threads, std::vector<float>& variance);

}  // namespace pivnp::piv

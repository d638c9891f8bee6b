// What is put in the place of vectors that are not trusted.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/record/vector_status.hpp"

namespace pivnp::piv {

/// Rebuilds rejected vectors from the valid ones among their eight neighbours, three at least: affine least squares if
/// they allow it, else the median; status becomes replaced. Up to `rings` rounds; later ones also use what earlier ones
/// rebuilt. The covariance becomes the neighbours' mean plus the scatter about the fit.
void replace_rejected(int nx, int ny, int rings, std::vector<std::array<float, 2>>& displacement,
                      std::vector<VectorStatus>& status, std::vector<std::array<float, 3>>& cov);

}  // namespace pivnp::piv

// What the error of a deformation gradient makes of its strains.
#pragma once

#include <array>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// Mean squares of the errors of the logarithmic strain's two invariants; NaN where F is not positive or `row` is not known.
struct StrainVariance {
  double dev = 0, vol = 0;
};

/// `row`: covariance (xx, yy, xy) of the errors of a row of F; both rows have it, and are independent (`cov_F` of a motion).
/// The volumetric strain to first order. The deviatoric strain is the length of the deviator, which errors across it only ever
/// lengthen: with s^2 the variance along the deviator, T that of the other directions together,
///   dev = s^2 + T k T/(dev0^2 + k T),   k = 3/4,   dev0^2 = max(0, dev^2 - s^2 - T),
/// first order where strain is large, and all of s^2 + T (the mean square of what a still specimen shows) where there is none;
/// k is that of the square of one normal error, E (e^2/2)^2 = 3/4 T^2.
StrainVariance strain_variance(const Mat2& F, const std::array<double, 3>& row);

}  // namespace pivnp

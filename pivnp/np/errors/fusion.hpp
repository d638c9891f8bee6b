// Two estimates of one displacement, combined by their uncertainties.
#pragma once

#include <array>

#include "pivnp/core/math.hpp"

namespace pivnp::np {

struct Estimate {
  Vec2 value = Vec2::Zero();
  std::array<double, 3> cov{0, 0, 0};  // uu, vv, uv
};

/// The combination of least variance, errors independent: a + K (b - a) with K = A (A + B)^-1 and covariance (I - K) A.
/// Where both are certain (A + B not positive definite) the second wins.
Estimate fuse(const Estimate& a, const Estimate& b);

/// K of fuse().
Mat2 fusion_weight(const Estimate& a, const Estimate& b);

/// The same for numbers, and the weight of the second.
struct Weighted {
  double weight, variance;
};
Weighted fuse(double variance_a, double variance_b);

/// (b - a)^T (A + B)^-1 (b - a): chi-squared with two degrees of freedom if both estimates are honest.
double disagreement(const Estimate& a, const Estimate& b);

}  // namespace pivnp::np

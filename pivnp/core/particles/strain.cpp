#include "pivnp/core/particles/strain.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

namespace pivnp {

namespace {

// 1/2 ln of S = F F^T by its eigenvalues (mean +- radius), J = det F > 0.
Strain half_log(const Mat2& S, double J) {
  const double mean = (S(0, 0) + S(1, 1)) / 2, half_difference = (S(0, 0) - S(1, 1)) / 2, shear = S(0, 1);
  const double radius = std::hypot(half_difference, shear);
  // The small eigenvalue from det S = J^2: mean - radius, and det S from S itself, would cancel at large stretch.
  const double large = mean + radius;
  const double small = J / large * J;
  if (!(small > 0) || !std::isfinite(large)) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  const double log_large = std::log(large) / 2, log_small = std::log(small) / 2;
  const double log_mean = (log_large + log_small) / 2;
  // (ln large - ln small) / (large - small), finite as they meet; log1p keeps its digits there.
  const double ratio = radius > 0 ? std::log1p(2 * radius / small) / (4 * radius) : 1 / (2 * mean);
  return {log_mean + ratio * half_difference, log_mean - ratio * half_difference, ratio * shear};
}

Strain symmetric(const Mat2& G) { return {G(0, 0), G(1, 1), (G(0, 1) + G(1, 0)) / 2}; }

}  // namespace

Strain log_strain(const Mat2& F) {
  const double J = F.determinant();
  return half_log(F * F.transpose(), J > 0 ? J : std::numeric_limits<double>::quiet_NaN());
}

Strain log_strain_material(const Mat2& F) { return log_strain(F.transpose()); }

double deviatoric(const Strain& e) {
  const double mean = volumetric(e) / 3;
  const double xx = e.xx - mean, yy = e.yy - mean, zz = -mean;
  return std::sqrt(2.0 / 3.0 * (xx * xx + yy * yy + zz * zz + 2 * e.xy * e.xy));
}

Principal principal(const Strain& e) {
  const double mean = (e.xx + e.yy) / 2, radius = std::hypot((e.xx - e.yy) / 2, e.xy);
  double angle = std::atan2(2 * e.xy, e.xx - e.yy) / 2;
  if (angle <= -std::numbers::pi / 2) angle = std::numbers::pi / 2;  // along y, reached with a shear of -0
  return {mean + radius, mean - radius, angle};
}

Strain increment_forward(const Mat2& F0, const Mat2& F1) { return symmetric(F1 * F0.inverse() - Mat2::Identity()); }

Strain increment_central(const Mat2& F0, const Mat2& F1) {
  // F1 F0^-1 = (I - G/2)^-1 (I + G/2)  =>  G = 2 (f - I)(f + I)^-1
  const Mat2 f = F1 * F0.inverse();
  return symmetric(2 * (f - Mat2::Identity()) * (f + Mat2::Identity()).inverse());
}

}  // namespace pivnp

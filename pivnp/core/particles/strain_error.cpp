#include "pivnp/core/particles/strain_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp {

namespace {

double square(double x) { return x * x; }

}  // namespace

// In the principal axes of C = F^T F, N_1 and N_2, with the stretches l_1 >= l_2 and their images n_1, n_2, an error E of F has
// the components n_i E N_j of variance P_jj = N_j R N_j. To first order the principal strains err by E_ii/l_i, and the shear
// between them by q (l_2 E_12 + l_1 E_21), q = ln(l_1/l_2)/(l_1^2 - l_2^2).
StrainVariance strain_variance(const Mat2& F, const std::array<double, 3>& row) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), J = F.determinant();
  const Mat2 C = F.transpose() * F;
  const double mean = (C(0, 0) + C(1, 1)) / 2, radius = std::hypot((C(0, 0) - C(1, 1)) / 2, C(0, 1)), large = mean + radius;
  const double small = J / large * J;  // squares of the stretches
  if (!(J > 0) || !(small > 0) || !std::isfinite(large)) return {nan, nan};
  const double angle = std::atan2(2 * C(0, 1), C(0, 0) - C(1, 1)) / 2, c = std::cos(angle), s = std::sin(angle);
  const double P1 = c * c * row[0] + s * s * row[1] + 2 * c * s * row[2], P2 = s * s * row[0] + c * c * row[1] - 2 * c * s * row[2];
  const double e1 = std::log(large) / 2, e2 = std::log(small) / 2, V1 = P1 / large, V2 = P2 / small;
  const double q = radius > 0 ? std::log1p(2 * radius / small) / (4 * radius) : 1 / (2 * mean);
  // dev^2 = (e1 - e2)^2/3 + (e1 + e2)^2/9 + 4/3 e12^2
  const double all = (V1 + V2) * (1.0 / 3 + 1.0 / 9) + 4.0 / 3 * q * q * (small * P2 + large * P1);
  const double dev2 = square(e1 - e2) / 3 + square(e1 + e2) / 9;
  StrainVariance out{all, V1 + V2};
  if (!(dev2 > all)) return out;
  const double apart = (e1 - e2) / 3, together = (e1 + e2) / 9;
  const double along = (square(together + apart) * V1 + square(together - apart) * V2) / dev2, across = std::max(0.0, all - along);
  constexpr double k = 0.75;
  if (across > 0) out.dev = along + across * k * across / (dev2 - all + k * across);
  return out;
}

}  // namespace pivnp

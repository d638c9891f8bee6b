#include "mpm/transfer/finite_strain.hpp"

#include <cmath>

namespace pivnp::mpm {

double log_det(const Gradient& G) { return std::log1p(G.xx + G.yy + G.xx * G.yy - G.xy * G.yx); }

Polar polar(const Gradient& G) {
  const double a = 2 + G.xx + G.yy, b = G.yx - G.xy;
  const double r = std::sqrt(a * a + b * b), cos = a / r, sin = b / r;
  // V = f R^T; the parts of V - I, without cancellation.
  const double vxx = G.xx * cos - G.xy * sin - b * b / (r * (r + a));
  const double vyy = G.yx * sin + G.yy * cos - b * b / (r * (r + a));
  const double vxy = (1 + G.xx) * sin + G.xy * cos;
  const double mean = 0.5 * (vxx + vyy), half = 0.5 * (vxx - vyy), radius2 = half * half + vxy * vxy;
  // ln V = 1/2 ln det V I + atanh(q)/q dev V/(1 + mean), q = radius/(1 + mean).
  const double per = 1 / (1 + mean), q2 = radius2 * per * per;
  double factor = 1 + q2 * (1.0 / 3 + q2 * (1.0 / 5 + q2 / 7));
  if (q2 > 1e-3) factor = std::atanh(std::sqrt(q2)) / std::sqrt(q2);
  const double log_mean = 0.5 * std::log1p(2 * mean + mean * mean - radius2);
  return {log_mean + factor * half * per, log_mean - factor * half * per, factor * vxy * per, 2 * b / (r + a)};
}

}  // namespace pivnp::mpm

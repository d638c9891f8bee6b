#include "pivnp/np/local_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace pivnp::np {

double LocalFit::weight(int k) {
  const double r2 = (place(k) - Vec2(0.5, 0.5)).squaredNorm();
  return 1 / ((1 + r2) * (1 + r2));
}

std::optional<LocalFit> LocalFit::of(std::uint16_t nodes, const std::array<std::array<double, 2>, 16>& values) {
  const int count = std::popcount(nodes);
  if (count < 3) return std::nullopt;
  auto used = [nodes](int k) { return (nodes >> k & 1) != 0; };
  auto value_of = [&](int k) { return Vec2(values[std::size_t(k)][0], values[std::size_t(k)][1]); };

  LocalFit fit;
  fit.nodes = nodes;
  for (int k = 0; k < 16; ++k) {
    if (!used(k)) continue;
    fit.weight_sum += weight(k);
    fit.centroid += weight(k) * place(k);
    fit.value += weight(k) * value_of(k);
  }
  fit.centroid /= fit.weight_sum;
  fit.value /= fit.weight_sum;

  Mat2 scatter = Mat2::Zero(), moment = Mat2::Zero();
  for (int k = 0; k < 16; ++k) {
    if (!used(k)) continue;
    const Vec2 r = place(k) - fit.centroid;
    scatter += weight(k) * r * r.transpose();
    moment += weight(k) * (value_of(k) - fit.value) * r.transpose();
  }
  // On a 4 x 4 lattice three nodes are either on one line or far from it: only round-off has to be told apart.
  if (!(scatter.determinant() > 1e-6 * scatter.trace() * scatter.trace())) return std::nullopt;
  fit.inverse_scatter = scatter.inverse();
  fit.slope = moment * fit.inverse_scatter;

  if (count > 3) {
    const double scale = double(count) / double(count - 3) / fit.weight_sum;
    for (int k = 0; k < 16; ++k) {
      if (!used(k)) continue;
      const Vec2 left = value_of(k) - fit.value - fit.slope * (place(k) - fit.centroid);
      fit.misfit[0] += scale * weight(k) * left.x() * left.x();
      fit.misfit[1] += scale * weight(k) * left.y() * left.y();
      fit.misfit[2] += scale * weight(k) * left.x() * left.y();
    }
  }
  return fit;
}

double LocalFit::influence(int k, double xi, double eta) const {
  if ((nodes >> k & 1) == 0) return 0;
  return weight(k) * (1 / weight_sum + (place(k) - centroid).dot(inverse_scatter * (Vec2(xi, eta) - centroid)));
}

bool LocalFit::reaches(double xi, double eta) const {
  constexpr double round_off = 1e-9;
  const Vec2 x(xi, eta);
  std::array<double, 16> angle{};
  std::size_t count = 0;
  for (int k = 0; k < 16; ++k) {
    if ((nodes >> k & 1) == 0) continue;
    const Vec2 r = place(k) - x;
    if (r.norm() <= reach + round_off) return true;
    angle[count++] = std::atan2(r.y(), r.x());
  }
  // Outside the hull a half-plane through x holds no node: the directions to the nodes leave a gap above pi.
  std::sort(angle.begin(), angle.begin() + std::ptrdiff_t(count));
  double gap = angle[0] + 2 * std::numbers::pi - angle[count - 1];
  for (std::size_t n = 1; n < count; ++n) gap = std::max(gap, angle[n] - angle[n - 1]);
  return gap <= std::numbers::pi + round_off;
}

}  // namespace pivnp::np

#include "pivnp/core/particles/coverage.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pivnp/core/particles/strain.hpp"

namespace pivnp {

namespace {

constexpr double enlarged = 1.3, most_stretch = 3;  // F of a torn particle says nothing about its extent

// The square of a particle, or the rectangle where cells are none: world offsets to shares of its half edges.
Mat2 to_square(const Mat2& F, const Vec2& edges) {
  const bool sound = F.allFinite() && F.determinant() > 0 && F.norm() < most_stretch * std::sqrt(2.0);
  return (2 / (enlarged * edges.array())).matrix().asDiagonal() * (sound ? Mat2(F.inverse()) : Mat2(Mat2::Identity()));
}

// The frame nearest to a time (some may have been dropped); -1: the motion does not reach there.
std::ptrdiff_t frame_near(const std::vector<double>& t, double time) {
  if (t.empty()) return -1;
  const double step = t.size() > 1 ? (t.back() - t.front()) / double(t.size() - 1) : std::abs(t[0]);
  if (time < t.front() - 0.51 * step - 1e-12 || time > t.back() + 0.51 * step + 1e-12) return -1;
  return std::min_element(t.begin(), t.end(), [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); }) - t.begin();
}

}  // namespace

std::vector<std::uint8_t> covered_nodes(const MotionSource& motion, double time, const Grid& grid) {
  const std::ptrdiff_t at = frame_near(motion.times(), time);
  if (at < 0) return {};
  const ParticleSet& particles = motion.particles();
  const MotionFrame frame = motion.frame(std::size_t(at));
  std::vector<std::uint8_t> inside(grid.node_count(), 0);
  const double aspect = std::sqrt(grid.spacing.x() / grid.spacing.y());
  const Vec2 shape(aspect, 1 / aspect);  // particles part a cell evenly along both axes
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double h = std::sqrt(particles.area[p]);
    if (!(h > 0)) return {};
    if (frame.status[p] == ParticleStatus::unborn) continue;
    const Vec2 centre = particles.x0[p] + Vec2(double(frame.u[p][0]), double(frame.u[p][1]));
    if (!centre.allFinite()) continue;
    const Mat2 square = to_square(matrix(frame.F[p]), h * shape);
    const Vec2 reach = square.inverse().cwiseAbs().rowwise().sum();
    const auto index = [&](double from, int axis, int count) {
      return int(std::clamp(from / grid.spacing[axis], -1.0, double(count)));
    };
    const Vec2 low = centre - reach - grid.origin, high = centre + reach - grid.origin;
    for (int j = std::max(0, index(low.y(), 1, grid.ny)); j <= std::min(grid.ny - 1, index(high.y(), 1, grid.ny)); ++j)
      for (int i = std::max(0, index(low.x(), 0, grid.nx)); i <= std::min(grid.nx - 1, index(high.x(), 0, grid.nx)); ++i)
        if ((square * (grid.position(i, j) - centre)).cwiseAbs().maxCoeff() <= 1) inside[grid.node(i, j)] = 1;
  }
  return inside;
}

}  // namespace pivnp

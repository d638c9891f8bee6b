#include "apps/report/content/material.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/report/content/selection.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::report {

namespace {

constexpr double enlarged = 1.3, most_stretch = 3;  // F of a torn particle says nothing about its extent

// The square of a particle: world offsets to shares of its half edges.
Mat2 to_square(const Mat2& F, double h) {
  const bool sound = F.allFinite() && F.determinant() > 0 && F.norm() < most_stretch * std::sqrt(2.0);
  return (sound ? Mat2(F.inverse()) : Mat2(Mat2::Identity())) * (2 / (enlarged * h));
}

}  // namespace

std::vector<std::uint8_t> nodes_in_material(const Content& content, const VectorField& field) {
  const auto first = std::size_t(std::max(0, field.pair[0]));
  if (!content.tracked || first >= content.frames.size()) return {};
  const std::optional<std::size_t> at = frame_at(*content.tracked, content.frames[first].time);
  if (!at) return {};
  const ParticleSet& particles = content.tracked->particles();
  const MotionFrame frame = content.tracked->frame(*at);
  const Grid& grid = field.grid;
  std::vector<std::uint8_t> inside(grid.node_count(), 0);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double h = particle_spacing(particles, p);
    if (!(h > 0)) return {};
    if (frame.status[p] == ParticleStatus::unborn) continue;
    const Vec2 centre = particles.x0[p] + Vec2(double(frame.u[p][0]), double(frame.u[p][1]));
    if (!centre.allFinite()) continue;
    const Mat2 square = to_square(matrix(frame.F[p]), h);
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

}  // namespace pivnp::report

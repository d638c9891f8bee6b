// What the water in the pores presses the material's faces with, where they rub on walls or on other material.
#include <Eigen/Dense>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

namespace {

constexpr double level_field = 1e-3;  // of the weights, in cells squared: what points in one row or none leave open

}  // namespace

// Under a uniform pressure p the points press a node with p sum V grad N, which inside is zero, and at a face its area.
// The pressure at an impervious face is that of the linear field nearest to the potentials of the points beside it:
// where water has had no time to flow, it changes up to the face.
std::vector<PoreWater::Thrust> PoreWater::thrust(const Particles& p, const GridState& g, const Vec2& gravity,
                                                 double time, const std::vector<std::uint32_t>& nodes,
                                                 int threads) const {
  std::vector<Thrust> out(nodes.size());
  const auto of_node = [&](auto shape, std::size_t a) {
    using S = decltype(shape);
    const std::size_t node = nodes[a], row = std::size_t(g.grid.nx), i = node % row, j = node / row;
    const Vec2 place = g.position(node), h = g.grid.spacing;
    Vec2 area = Vec2::Zero();
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    Eigen::Vector3d potential = Eigen::Vector3d::Zero();
    for (std::size_t below = 0; below < std::size_t(S::width) && below <= j; ++below) {
      const std::size_t in_row = node - below * row - i, last = std::min(i, row - 2),
                        first = i - std::min(i, std::size_t(S::width) - 1);
      for_points<S>(
          p, g, {g.cells.first_from(std::int32_t(in_row + first)), g.cells.first_from(std::int32_t(in_row + last + 1))},
          [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
            if (!soil_of(p, k).holds_water()) return;
            for (int c = 0; c < S::width * S::width; ++c) {
              if (at[c] != node) continue;
              const int ax = c % S::width, ay = c / S::width;
              const double v = p.volume0[k] * p.J[k], w = v * x.w[ax] * y.w[ay];
              area += v * Vec2(x.g[ax] * y.w[ay] * g.per_hx, x.w[ax] * y.g[ay] * g.per_hy);
              if (g.axisymmetric) area.x() += w / p.x[k];
              const Eigen::Vector3d field(1, (p.x[k] - place.x()) / h.x(), (p.y[k] - place.y()) / h.y());
              moments += w * field * field.transpose();
              potential += w * (p.pressure[k] - head({p.x[k], p.y[k]}, gravity)) * field;
            }
          });
    }
    if (!(moments(0, 0) > 0)) return;
    moments(1, 1) += level_field * moments(0, 0);
    moments(2, 2) += level_field * moments(0, 0);
    const double there = moments.ldlt().solve(potential)[0];
    const PoreCondition* condition = boundaries_.at(node, time);
    const double pressure = condition && condition->gives_pressure() ? given_pressure(*condition, place, gravity)
                                                                     : there + head(place, gravity);
    out[a] = {true, pressure - outside_pressure(place, gravity), Vec2::Zero()};
    out[a].force = out[a].pressure * area;
  };
  Shapes::with(g.shape,
               [&](auto shape) { for_each(nodes.size(), threads, [&](std::size_t a) { of_node(shape, a); }); });
  return out;
}

}  // namespace pivnp::mpm

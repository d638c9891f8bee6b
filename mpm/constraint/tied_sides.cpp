#include "mpm/constraint/tied_sides.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

void TiedSides::tie(const Wall& first, const Wall& second, const GridGeometry& g) {
  const std::string key = first.key + ".across_m";
  if (first.side == wall_none || second.side == wall_none || first.side == second.side)
    throw InputError(key + ": expected both sides along the grid, on lines of nodes, with the material between");
  const Vec2 apart = (second.from - first.from).cwiseQuotient(g.grid.spacing);
  const auto offset = std::ptrdiff_t(std::lround(apart.x())) + std::ptrdiff_t(std::lround(apart.y())) * g.grid.nx;
  if ((apart - Vec2(std::round(apart.x()), std::round(apart.y()))).norm() > 1e-6 || offset == 0)
    throw InputError(key + ": expected a whole number of cells");
  seams_.push_back({first.from, second.from - first.from, first.until});
  for (const std::uint32_t n : first.nodes) {
    const std::ptrdiff_t opposite = std::ptrdiff_t(n) + offset;
    if (opposite < 0 || !std::binary_search(second.nodes.begin(), second.nodes.end(), std::uint32_t(opposite)))
      throw InputError(key + ": a node of line_m has none opposite in the grid, expected both sides inside it");
    for (std::size_t field = 0; field < std::size_t(g.velocity_fields); ++field) {
      const auto from = std::uint32_t(field * g.field_nodes());
      ties_.push_back({{from + n, from + std::uint32_t(opposite)}, first.until});
    }
  }
}

void TiedSides::apply(double time, GridState& g, std::vector<Reaction>& reactions) const {
  for (const Tie& tie : ties_) {
    Node &a = g.node[tie.node[0]], &b = g.node[tie.node[1]];
    if (time >= tie.until || !(a.mass > 0 && b.mass > 0)) continue;
    const double mass = a.mass + b.mass, reduced = a.mass * b.mass / mass;
    const Vec2 impulse = reduced * Vec2(b.nx - a.nx, b.ny - a.ny);
    reactions.push_back({tie.node[0], impulse.x(), impulse.y(), 0, 0});
    reactions.push_back({tie.node[1], -impulse.x(), -impulse.y(), 0, 0});
    a.nx = b.nx = (a.mass * a.nx + b.mass * b.nx) / mass;
    a.ny = b.ny = (a.mass * a.ny + b.mass * b.ny) / mass;
    a.hold();
    b.hold();
  }
}

void TiedSides::apply_to_strain_velocity(double time, GridState& g, bool equilibrium) const {
  for (const Tie& tie : ties_) {
    const Node &a = g.node[tie.node[0]], &b = g.node[tie.node[1]];
    if (time >= tie.until || !(a.mass > 0 && b.mass > 0)) continue;
    const double mass = a.mass + b.mass;
    const GridState::StrainVelocity u = g.strain_velocity(tie.node[0]), w = g.strain_velocity(tie.node[1]);
    const double x = (a.mass * u.x + b.mass * w.x) / mass, y = (a.mass * u.y + b.mass * w.y) / mass;
    if (equilibrium || g.has_own_strain_velocity(tie.node[0])) u.x = x, u.y = y;
    if (equilibrium || g.has_own_strain_velocity(tie.node[1])) w.x = x, w.y = y;
  }
}

void TiedSides::carry_over(double time, Particles& p) const {
  for (const Seam& seam : seams_) {
    if (time >= seam.until) continue;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const double share = (Vec2(p.x[k], p.y[k]) - seam.from).dot(seam.across) / seam.across.squaredNorm();
      if (share >= 0 && share <= 1) continue;
      const Vec2 by = share < 0 ? seam.across : Vec2(-seam.across);
      p.x[k] += by.x();
      p.y[k] += by.y();
      p.carried_x[k] += by.x();
      p.carried_y[k] += by.y();
    }
  }
}

}  // namespace pivnp::mpm

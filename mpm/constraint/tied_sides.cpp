#include "mpm/constraint/tied_sides.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
  const bool along_y = std::abs(first.to.x() - first.from.x()) < 0.5 * g.grid.spacing.x();
  const double distance = along_y ? apart.x() : apart.y();
  const Vec2 between = second.from - first.from;
  seams_.push_back({first.from, between, along_y ? Vec2(1 / between.x(), 0) : Vec2(0, 1 / between.y()), first.until});
  for (const std::uint32_t n : first.nodes) {
    const std::ptrdiff_t opposite = std::ptrdiff_t(n) + offset;
    if (opposite < 0 || !std::binary_search(second.nodes.begin(), second.nodes.end(), std::uint32_t(opposite)))
      throw InputError(key + ": a node of line_m has none opposite in the grid, expected both sides inside it");
    for (std::size_t field = 0; field < std::size_t(g.velocity_fields); ++field) {
      const auto from = std::uint32_t(field * g.field_nodes());
      ties_.push_back({{from + n, from + std::uint32_t(opposite)}, first.until, along_y});
      tie_rings(ties_.back(), along_y ? 1 : g.grid.nx, std::ptrdiff_t(std::lround(std::abs(distance))), distance > 0 ? offset : -offset, g.centred);
    }
  }
}

// Nodes that lie whole periods apart are one: those on the sides' normal through the lower of both, and those that `offset` leads to.
void TiedSides::tie_rings(const Tie& tie, std::ptrdiff_t next, std::ptrdiff_t period, std::ptrdiff_t offset, bool beyond) {
  const std::ptrdiff_t low = std::ptrdiff_t(tie.node[0]) + offset == std::ptrdiff_t(tie.node[1]) ? tie.node[0] : tie.node[1];
  const std::ptrdiff_t reach = beyond ? 1 : 0;
  for (std::ptrdiff_t from = -reach; from < period - reach; ++from) {
    Ring ring{{}, tie.until};
    for (std::ptrdiff_t at = from, times = 0; at <= period + reach; at += period, ++times) ring.nodes.push_back(std::uint32_t(low + from * next + times * offset));
    if (ring.nodes.size() > 1) rings_.push_back(std::move(ring));
  }
}

namespace {

struct Common {
  double mass = 0, x = 0, y = 0;  // momentum, then velocity
};

// Of the nodes of a ring that have mass.
template <class Velocity>
Common common_of(const std::vector<std::uint32_t>& nodes, const GridState& g, Velocity&& velocity) {
  Common all;
  for (const std::uint32_t n : nodes) {
    const double mass = g.node[n].mass;
    if (!(mass > 0)) continue;
    const auto [x, y] = velocity(n);
    all.mass += mass;
    all.x += mass * x;
    all.y += mass * y;
  }
  if (all.mass > 0) all.x /= all.mass, all.y /= all.mass;
  return all;
}

}  // namespace

void TiedSides::apply(double time, GridState& g, std::vector<Reaction>& reactions) const {
  for (const Ring& ring : rings_) {
    if (time >= ring.until) continue;
    const Common all = common_of(ring.nodes, g, [&](std::uint32_t n) { return std::pair{g.node[n].nx, g.node[n].ny}; });
    const Common was = common_of(ring.nodes, g, [&](std::uint32_t n) { return std::pair{g.node[n].vx, g.node[n].vy}; });
    for (const std::uint32_t n : ring.nodes) {
      Node& node = g.node[n];
      if (node.mass > 0) node.vx = was.x, node.vy = was.y;
      if (!(node.mass > 0) || !(node.mass < all.mass)) continue;
      reactions.push_back({n, node.mass * (all.x - node.nx), node.mass * (all.y - node.ny), 0, 0});
      node.nx = all.x;
      node.ny = all.y;
      node.hold();
    }
  }
}

void TiedSides::apply_to_strain_velocity(double time, GridState& g, bool equilibrium) const {
  for (const Ring& ring : rings_) {
    if (time >= ring.until) continue;
    const Common all = common_of(ring.nodes, g, [&](std::uint32_t n) { return std::pair{g.strain_velocity(n).x, g.strain_velocity(n).y}; });
    for (const std::uint32_t n : ring.nodes) {
      if (!(g.node[n].mass > 0) || !(g.node[n].mass < all.mass) || !(equilibrium || g.has_own_strain_velocity(n))) continue;
      const GridState::StrainVelocity u = g.strain_velocity(n);
      u.x = all.x, u.y = all.y;
    }
  }
}

void TiedSides::carry_over(double time, Particles& p) const {
  for (const Seam& seam : seams_) {
    if (time >= seam.until) continue;
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const double share = (Vec2(p.x[k], p.y[k]) - seam.from).dot(seam.normal);
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

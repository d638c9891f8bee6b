#include "mpm/step/half_step.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/step/energy.hpp"

namespace pivnp::mpm {

namespace {

// (Second moments of weights, over the cell's square, below which there is no affine field: as where a point lies on a node.)
constexpr double least_moment = 0.02;

double limited(double change, double by_force) {
  return change * by_force <= 0 ? 0 : std::copysign(std::min(std::abs(change), std::abs(by_force)), change);
}

Vec2 change_of(const Node& node, double push_s) {
  const Vec2 change(node.nx - node.vx, node.ny - node.vy);
  if (!node.held_x && !node.held_y) return change;
  const double per_mass = push_s / node.mass;
  return {node.held_x ? limited(change.x(), per_mass * node.fx) : change.x(),
          node.held_y ? limited(change.y(), per_mass * node.fy) : change.y()};
}

}  // namespace

VelocityChange pushed_on(const Particles& p, const GridState& g, std::size_t k, const LastPush& last) {
  VelocityChange out;
  const double share = last.share();
  if (!(share > 0) || p.cell[k] == Particles::ended || g.blocks.sleeps(p.cell[k])) return out;
  std::int32_t cell = 0;
  double xi = 0, eta = 0, weight[most_stencil_nodes];
  std::size_t at[most_stencil_nodes];
  const int field = int(std::size_t(p.cell[k]) / g.field_nodes());
  // Where the point was when it was pushed, but for what its velocity and the nodes' differ by in a step.
  const Vec2 x(p.x[k] - last.step_s * p.vx[k], p.y[k] - last.step_s * p.vy[k]);
  if (!g.find(x.x(), x.y(), cell, xi, eta, field)) return out;
  g.weights_at(cell, xi, eta, at, weight);
  double sum = 0;
  Vec2 moment = Vec2::Zero();
  for (int c = 0; c < g.stencil; ++c) {
    const Node& node = g.node[at[c]];
    if (!(node.mass > 0)) continue;
    const Vec2 change = weight[c] * change_of(node, last.push_s), arm = g.place(at[c]) - x;
    sum += weight[c];
    out.v += change;
    out.affine += change * arm.transpose();
    moment += weight[c] * arm.cwiseAbs2();
  }
  if (!(sum > 0)) return {};
  out.v *= share / sum;
  for (int axis = 0; axis < 2; ++axis) {
    const double least = least_moment * g.grid.spacing[axis] * g.grid.spacing[axis];
    out.affine.col(axis) *= !p.C_xx.empty() && moment[axis] > least ? share / moment[axis] : 0;
  }
  return out;
}

Vec2 pushed_momentum(const Particles& p, const GridState& g, const LastPush& last) {
  Vec2 sum = Vec2::Zero();
  if (!(last.share() > 0)) return sum;
  double pushed = 0, now = 0;  // densities may have changed since
  for (const std::uint32_t n : g.active.nodes) {
    if (!(g.node[n].mass > 0)) continue;
    pushed += g.node[n].mass;
    sum += g.node[n].mass * change_of(g.node[n], last.push_s);
  }
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) now += p.mass_of(k);
  return pushed > 0 ? Vec2(last.share() * now / pushed * sum) : sum;
}

double pushed_kinetic(const Particles& p, const GridState& g, const LastPush& last) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended) continue;
    const VelocityChange more = pushed_on(p, g, k, last);
    const Vec2 v(p.vx[k], p.vy[k]);
    sum += stored_kinetic(p, g, k) + p.mass_of(k) * more.v.dot(v + 0.5 * more.v);
    if (p.C_xx.empty()) continue;
    const Mat2 before{{p.C_xx[k], p.C_xy[k]}, {p.C_yx[k], p.C_yy[k]}}, after = before + more.affine;
    for (int axis = 0; axis < 2; ++axis)
      sum += p.mass_of(k) * 0.125 * g.grid.spacing[axis] * g.grid.spacing[axis] * (after.col(axis).squaredNorm() - before.col(axis).squaredNorm());
  }
  return sum;
}

}  // namespace pivnp::mpm

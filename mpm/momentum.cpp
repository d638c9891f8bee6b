#include "mpm/momentum.hpp"

#include <cmath>

namespace pivnp::mpm {

namespace {

double damping_force(double alpha, double force, double velocity) {
  return velocity > 0 ? -alpha * std::abs(force) : velocity < 0 ? alpha * std::abs(force) : 0.0;
}

}  // namespace

void update_momentum(GridState& g, const Vec2& gravity, double damping, double dt, int threads) {
  const auto n = std::ptrdiff_t(g.nodes.size());
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1)
  for (std::ptrdiff_t a = 0; a < n; ++a) {
    Node& node = g.node[g.nodes[std::size_t(a)]];
    node.fx += node.mass * gravity.x();
    node.fy += node.mass * gravity.y();
    node.dx = node.dy = 0;
    if (damping > 0) {
      node.dx = damping_force(damping, node.fx, node.vx);
      node.dy = damping_force(damping, node.fy, node.vy);
    }
    const double step = node.mass > 0 ? dt / node.mass : 0;
    node.nx = node.vx + step * (node.fx + node.dx);
    node.ny = node.vy + step * (node.fy + node.dy);
  }
}

NodalWork nodal_work(const GridState& g, const std::vector<Reaction>& reactions, double damping, double dt) {
  NodalWork work;
  for (const Reaction& r : reactions) {
    const Node& node = g.node[r.node];
    const double done = 0.5 * (r.impulse_x * (node.vx + node.ux) + r.impulse_y * (node.vy + node.uy));
    const double by_wall = r.impulse_x * r.wall_x + r.impulse_y * r.wall_y;
    work.bodies += by_wall;
    work.contact += by_wall - done;
  }
  if (damping > 0)
    for (const std::uint32_t n : g.nodes) {
      const Node& node = g.node[n];
      work.damping -= 0.5 * dt * (node.dx * (node.vx + node.ux) + node.dy * (node.vy + node.uy));
    }
  return work;
}

}  // namespace pivnp::mpm

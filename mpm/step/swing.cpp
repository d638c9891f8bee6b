#include "mpm/step/swing.hpp"

#include <utility>
#include <vector>

#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

double twice_kinetic_of_points(const Particles& p) {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass_of(k) * (p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k]);
  return sum;
}

}  // namespace

Swing leapfrog_swing(const Particles& p, GridState& g, const Scheme& scheme, const Vec2& gravity, const LastPush& last,
                     int threads) {
  Swing swing;
  if (!(last.step_s > 0)) return swing;
  std::vector<Vec2> before;  // forces of the last push, which what follows may still ask for
  for (const std::uint32_t n : g.active.nodes) before.emplace_back(g.node[n].fx, g.node[n].fy);
  average_mean_stress(p, g, scheme, threads);
  map_force(p, g, scheme, threads);
  double power = 0, change = 0, twice_kinetic = 0;
  for (std::size_t a = 0; a < before.size(); ++a) {
    Node& node = g.node[g.active.nodes[a]];
    const Vec2 u = std::as_const(g).strain_velocity(g.active.nodes[a]);
    Vec2 force(node.fx + node.mass * gravity.x(), node.fy + node.mass * gravity.y());
    if (g.arrays.loads.size() > 0)
      force += Vec2(g.arrays.loads[g.active.nodes[a]].x, g.arrays.loads[g.active.nodes[a]].y);
    node.fx = before[a].x();
    node.fy = before[a].y();
    if (!(node.mass > 0)) continue;
    power += force.dot(u);
    change += (before[a] - force).dot(u);
    twice_kinetic += node.mass * u.dot(Vec2(node.nx, node.ny));
  }
  // (What swings are the points' velocities then, and the strains are those of u = S w; else u = P n.)
  if (scheme.stress == StressUpdate::musl && scheme.transfer == TransferKind::flip) twice_kinetic = twice_kinetic_of_points(p);
  swing.energy = -0.5 * last.step_s * power;
  swing.share2 = twice_kinetic > 0 ? 0.25 * last.step_s * change / twice_kinetic : 1;
  return swing;
}

}  // namespace pivnp::mpm

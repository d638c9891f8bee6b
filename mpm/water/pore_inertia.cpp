// The water's own inertia (docs/theory/mpm_water.md#inertia-of-the-water): flow along an edge follows
//   (rho_w/n) dq/dt + q/lambda = -(grad e + rho_w a),
// the drag implicit, and the mixture feels -rho_w dq/dt. Acceleration a of an edge and the force on its nodes have the
// same weights, the nodes' volumes, so that light nodes of a surface drive nothing.
#include <cmath>

#include "mpm/water/pore_water.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

enum { inert_ax, inert_ay, inert_qx, inert_qy, inert_size };  // of the state; flow: into the node from the next one, m^2/s

}  // namespace

void PoreWater::check_inertia(const Particles& p, const Vec2& gravity) const {
  if (!options_.inertia) return;
  const auto refuse = [](const std::string& beside) {
    throw InputError("water.inertia: found true beside " + beside + ", expected false");
  };
  if (projected()) refuse("mpm.pressure = \"projected\"");
  if (imposed()) refuse("water.groundwater = \"level\"");
  if (alike_.own) refuse("materials of several kinds, or with permeability = \"kozeny_carman\"");
  if (ties_->any()) refuse("a tied boundary");
  if (surface_may_move(p) && sees_air(gravity)) refuse("pores that are not full or a level that moves");
}

// In the place of what the nodes' potentials alone exchanged along the edges in this step.
PoreFlow PoreWater::push_flow(const GridState& g, double dt, std::vector<double>& state) {
  PoreFlow sum;
  const PoreFields& f = field_;
  const double density = options_.density_kg_m3;
  std::vector<double> next(inert_size * g.grid.node_count(), 0.0);
  state.resize(next.size(), 0.0);
  pushed_.assign(g.grid.node_count(), Vec2::Zero());
  const auto edge = [&](std::size_t n, std::size_t other, int axis, double exchange) {
    if (!(exchange > 0) || !(f.volume[n] > 0) || !(f.volume[other] > 0) || (marks_[n].given && marks_[other].given))
      return;
    const double share = f.volume[n] / (f.volume[n] + f.volume[other]), h = g.grid.spacing[axis];
    const double porosity = (sums_.node[n].mobile + sums_.node[other].mobile) / (f.volume[n] + f.volume[other]);
    const double acceleration =
        share * state[inert_size * n + std::size_t(axis)] + (1 - share) * state[inert_size * other + std::size_t(axis)];
    const double drop = exchange * (f.potential[other] - f.potential[n]),
                 driven = drop + exchange * density * h * acceleration;
    const double lag = density * alike_.mobility / porosity, before = state[inert_size * n + std::size_t(inert_qx + axis)];
    const double after = (lag * before + driven) / (lag + dt), more = dt * after - drop;
    next[inert_size * n + std::size_t(inert_qx + axis)] = after;
    const double force = density * h * (after - before) / dt;
    pushed_[n][axis] += share * force;
    pushed_[other][axis] += (1 - share) * force;
    const auto gains = [&](std::size_t node, std::size_t from, double volume) {
      if (!marks_[node].given) f.change[node] += volume / f.volume[node];
      if (marks_[from].given) sum.add({volume, volume * f.potential[from], volume * f.potential[from]});
    };
    gains(n, other, more);
    gains(other, n, -more);
  };
  // (The edges' own exchange, PoreFields::flow_x, lacks what the points even out in their cells.)
  const double x = 0.5 * dt * alike_.mobility * g.per_hx * g.per_hx,
               y = 0.5 * dt * alike_.mobility * g.per_hy * g.per_hy;
  for (const std::uint32_t n : g.active.nodes) {
    const PoreElement* element = sums_.element + n;
    edge(n, n + 1, 0, x * (element->inside + element[-f.row].inside));
    edge(n, n + std::size_t(f.row), 1, y * (element->inside + element[-1].inside));
  }
  state.swap(next);
  return sum;
}

void PoreWater::push_nodes(GridState& g) const {
  for (const std::uint32_t n : g.active.nodes) {
    if (!(g.node[n].mass > 0)) continue;
    g.node[n].fx += pushed_[n].x();
    g.node[n].fy += pushed_[n].y();
  }
}

double PoreWater::accelerates(const GridState& g, double dt, std::vector<double>& state) const {
  double lost = 0;
  for (const std::uint32_t n : g.active.nodes) {
    const Node& node = g.node[n];
    double* of_node = state.data() + inert_size * n;
    of_node[inert_ax] = of_node[inert_ay] = 0;
    if (!(node.mass > 0)) continue;
    of_node[inert_ax] = (node.nx - node.vx) / dt;
    of_node[inert_ay] = (node.ny - node.vy) / dt;
    lost -= dt * pushed_[n].dot(Vec2(node.held_x ? node.nx : 0.5 * (node.vx + node.nx),
                                     node.held_y ? node.ny : 0.5 * (node.vy + node.ny)));
  }
  return lost;
}

// Roots c^2 of det([M + Q, Q; Q, Q] - c^2 [rho, rho_w; rho_w, rho_w/n]), Q = K_w/n.
double PoreWater::inert_stiffness(std::size_t material, double modulus, double density, double stiffness) const {
  const double water = options_.density_kg_m3, own = water / soils_[material].porosity;
  if (!(stiffness > 0)) return stiffness;
  const double a = density * own - water * water, b = (modulus + stiffness) * own + stiffness * (density - 2 * water);
  const double speed2 = (b + std::sqrt(std::max(0.0, b * b - 4 * a * modulus * stiffness))) / (2 * a);
  return std::max(stiffness, density * speed2 - modulus);
}

// Of a point in the element up and to the right of a node: the edges' flow over the volume that they stand for.
Vec2 PoreWater::inert_flow(const GridState& g, std::size_t n, double s, double t,
                           const std::vector<double>& state) const {
  const auto row = std::ptrdiff_t(field_.row);
  const auto of = [&](std::size_t node, int axis) {
    const std::ptrdiff_t beside = axis == 0 ? -row : -1;
    const double volume = 0.5 * (sums_.element[node].inside + (sums_.element + node)[beside].inside);
    return volume > 0 ? -state[inert_size * node + std::size_t(inert_qx + axis)] * g.grid.spacing[axis] / volume : 0.0;
  };
  return {(1 - t) * of(n, 0) + t * of(n + std::size_t(row), 0), (1 - s) * of(n, 1) + s * of(n + 1, 1)};
}

}  // namespace pivnp::mpm

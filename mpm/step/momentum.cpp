#include "mpm/step/momentum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

constexpr int most_sweeps = 60;  // of join_linearly(); 2 to 20 are enough

Vec2 damping_force(double alpha, const Node& node) {
  const auto along = [&](double force, double velocity) {
    return velocity > 0 ? -alpha * std::abs(force) : velocity < 0 ? alpha * std::abs(force) : 0.0;
  };
  return alpha > 0 ? Vec2(along(node.fx, node.vx), along(node.fy, node.vy)) : Vec2(0, 0);
}

double per_mass(const Node& node) { return node.mass > 0 ? 1 / node.mass : 0; }

void advance(Node& node, double per_mass, const Vec2& gravity, double damping, double dt) {
  node.fx += node.mass * gravity.x();
  node.fy += node.mass * gravity.y();
  const Vec2 damped = damping_force(damping, node);
  const double step = dt * per_mass;
  node.nx = node.vx + step * (node.fx + damped.x());
  node.ny = node.vy + step * (node.fy + damped.y());
}

// Of a node and its eight neighbours; of equals the first.
std::uint32_t heaviest_around(const GridState& g, std::uint32_t n) {
  const auto nx = std::ptrdiff_t(g.grid.nx), ny = std::ptrdiff_t(g.grid.ny);
  const std::ptrdiff_t i = std::ptrdiff_t(n) % nx, j = std::ptrdiff_t(n) / nx;
  std::uint32_t heavy = n;
  for (std::ptrdiff_t b = std::max<std::ptrdiff_t>(0, j - 1); b <= std::min(ny - 1, j + 1); ++b)
    for (std::ptrdiff_t a = std::max<std::ptrdiff_t>(0, i - 1); a <= std::min(nx - 1, i + 1); ++a)
      if (g.node[std::size_t(b * nx + a)].mass > g.node[heavy].mass) heavy = std::uint32_t(b * nx + a);
  return heavy;
}

// Along the grid's lines where a neighbour there has at least half as much as the heaviest, else to that one; and as that one, where
// the node beyond lacks mass.
SmallMassNodes::Pair outward(const GridState& g, std::uint32_t n) {
  const auto nx = std::ptrdiff_t(g.grid.nx), ny = std::ptrdiff_t(g.grid.ny);
  const std::ptrdiff_t i = std::ptrdiff_t(n) % nx, j = std::ptrdiff_t(n) / nx;
  const std::uint32_t heaviest = heaviest_around(g, n);
  const double enough = 0.5 * g.node[heaviest].mass;
  const auto node_at = [&](std::ptrdiff_t a, std::ptrdiff_t b) {
    return a < 0 || a >= nx || b < 0 || b >= ny ? n : std::uint32_t(b * nx + a);
  };
  const std::ptrdiff_t of_heaviest[2] = {std::ptrdiff_t(heaviest) % nx - i, std::ptrdiff_t(heaviest) / nx - j};
  const std::array<std::array<std::ptrdiff_t, 2>, 5> ways = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {of_heaviest[0], of_heaviest[1]}}};
  SmallMassNodes::Pair pair{n, heaviest, heaviest};
  for (const auto& [a, b] : ways) {
    const std::uint32_t first = node_at(i + a, j + b), second = node_at(i + 2 * a, j + 2 * b);
    if (g.node[first].mass >= enough && g.node[second].mass >= enough) {
      pair = {n, first, second};
      break;
    }
  }
  return pair;
}

void join_to_heaviest(GridState& g, const std::vector<SmallMassNodes::Pair>& pairs, double damping, double dt) {
  // A node may have several small ones: first all are added up, then all are told.
  std::vector<double> masses_before;
  for (const SmallMassNodes::Pair& p : pairs) {
    const Node& small = g.node[p.small];
    Node& node = g.node[p.heavy];
    masses_before.push_back(node.mass);
    const double mass = node.mass + small.mass;
    const Vec2 damped = damping_force(damping, small);
    node.nx = (node.mass * node.nx + small.mass * small.vx + dt * (small.fx + damped.x())) / mass;
    node.ny = (node.mass * node.ny + small.mass * small.vy + dt * (small.fy + damped.y())) / mass;
    node.mass = mass;
  }
  for (std::size_t k = pairs.size(); k-- > 0;) {
    Node &small = g.node[pairs[k].small], &heavy = g.node[pairs[k].heavy];
    small.nx = heavy.nx;
    small.ny = heavy.ny;
    heavy.mass = masses_before[k];
  }
}

// Where some go on linearly: with n = T n' of all, (T^T m T) n' = T^T (m v + dt f), by Jacobi's iteration, which takes
// a few sweeps since a pair couples two nodes. (Lumped, T^T m T would turn what moves linearly, and give it energy.)
void join_linearly(GridState& g, const std::vector<SmallMassNodes::Pair>& pairs, double damping, double dt) {
  struct Carrier {
    std::uint32_t node;
    double mass;         // its own
    double carried = 0;  // and of the small ones: sum w^2 m
    Vec2 momentum, residual{0, 0};
  };
  std::vector<Carrier> carriers;
  for (const SmallMassNodes::Pair& p : pairs)
    for (const std::uint32_t n : {p.heavy, p.beyond})
      carriers.push_back({n, g.node[n].mass, 0, g.node[n].mass * Vec2(g.node[n].nx, g.node[n].ny)});
  std::sort(carriers.begin(), carriers.end(), [](const Carrier& a, const Carrier& b) { return a.node < b.node; });
  carriers.erase(std::unique(carriers.begin(), carriers.end(),
                             [](const Carrier& a, const Carrier& b) { return a.node == b.node; }),
                 carriers.end());
  const auto carrier = [&](std::uint32_t n) -> Carrier& {
    return *std::lower_bound(carriers.begin(), carriers.end(), n,
                             [](const Carrier& c, std::uint32_t of) { return c.node < of; });
  };
  const auto for_shares = [&](const SmallMassNodes::Pair& p, const auto& each) {
    if (p.beyond == p.heavy) return each(carrier(p.heavy), 1.0);
    each(carrier(p.heavy), 2.0);
    each(carrier(p.beyond), -1.0);
  };
  std::vector<Vec2> momentum;  // of the small ones
  for (const SmallMassNodes::Pair& p : pairs) {
    const Node& small = g.node[p.small];
    momentum.push_back(small.mass * Vec2(small.vx, small.vy) +
                       dt * (Vec2(small.fx, small.fy) + damping_force(damping, small)));
    for_shares(p, [&](Carrier& c, double w) { c.carried += w * w * small.mass; });
  }
  const auto sweep = [&] {
    for (Carrier& c : carriers) c.residual = c.momentum - c.mass * Vec2(g.node[c.node].nx, g.node[c.node].ny);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Node &heavy = g.node[pairs[k].heavy], &beyond = g.node[pairs[k].beyond];
      const Vec2 moved(2 * heavy.nx - beyond.nx, 2 * heavy.ny - beyond.ny);
      const Vec2 left = momentum[k] - g.node[pairs[k].small].mass * moved;
      for_shares(pairs[k], [&](Carrier& c, double w) { c.residual += w * left; });
    }
    double change = 0, greatest = 0;
    for (const Carrier& c : carriers) {
      Node& node = g.node[c.node];
      const Vec2 by = c.residual / (c.mass + c.carried);
      node.nx += by.x();
      node.ny += by.y();
      change = std::max(change, by.norm());
      greatest = std::max(greatest, std::hypot(node.nx, node.ny));
    }
    return change > 1e-14 * greatest;
  };
  for (int k = 0; k < most_sweeps && sweep(); ++k) {
  }
  for (const SmallMassNodes::Pair& p : pairs) {
    Node& small = g.node[p.small];
    small.nx = 2 * g.node[p.heavy].nx - g.node[p.beyond].nx;
    small.ny = 2 * g.node[p.heavy].ny - g.node[p.beyond].ny;
  }
}

}  // namespace

void SmallMassNodes::find(const GridState& g, const Rule& rule) { pair_up(g, rule, g.active.nodes); }

void SmallMassNodes::pair_up(const GridState& g, const Rule& rule, const std::vector<std::uint32_t>& nodes) {
  pairs.clear();
  for (const std::uint32_t n : nodes) {
    if (!(g.node[n].mass < rule.least * g.measure(n))) continue;
    Pair pair = rule.linear ? outward(g, n) : Pair{n, heaviest_around(g, n), heaviest_around(g, n)};
    if (g.node[pair.beyond].mass < rule.least * g.measure(pair.beyond)) pair.beyond = pair.heavy;  // (small itself)
    if (g.node[pair.heavy].mass >= rule.least * g.measure(pair.heavy)) pairs.push_back(pair);
  }
}

void SmallMassNodes::join_momentum(GridState& g, double damping, double dt) const {
  const bool linear = std::any_of(pairs.begin(), pairs.end(), [](const Pair& p) { return p.beyond != p.heavy; });
  linear ? join_linearly(g, pairs, damping, dt) : join_to_heaviest(g, pairs, damping, dt);
}

void SmallMassNodes::join_velocity(GridState& g) const {
  for (std::size_t k = 0, n = 0; k < pairs.size(); k += n) {  // in runs along a row
    const std::uint32_t first = pairs[k].small, left = std::uint32_t(g.grid.nx) - first % std::uint32_t(g.grid.nx);
    for (n = 1; n < left && k + n < pairs.size() && pairs[k + n].small == first + n;) ++n;
    g.separate_strain_velocities(first, int(n));
  }
  for (const Pair& p : pairs) {
    const GridState::StrainVelocity small = g.strain_velocity(p.small), heavy = g.strain_velocity(p.heavy), beyond = g.strain_velocity(p.beyond);
    small.x = 2 * heavy.x - beyond.x;
    small.y = 2 * heavy.y - beyond.y;
  }
}

void update_momentum(GridState& g, const Vec2& gravity, double damping, double dt, int threads) {
  for_nodes(g, threads, [&](Node& node, std::uint32_t) { advance(node, per_mass(node), gravity, damping, dt); });
}

void map_and_update(const Particles& p, GridState& g, const Scheme& scheme, SmallMassNodes& small, const SmallMassNodes::Rule& rule,
                    const Vec2& gravity, double dt, int threads) {
  std::vector<std::vector<std::uint32_t>> found(g.active.mapped.count());
  const double rounding = mass_of_rounding(p);
  map_sums(p, g, scheme, true, threads, [&](Range nodes, std::size_t band) {
    for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
      Node& node = g.node[g.active.nodes[a]];
      if (node.mass < rounding) forget_sums(node);
      const double per = per_mass(node);
      node.vx *= per;
      node.vy *= per;
      advance(node, per, gravity, scheme.damping, dt);
      if (node.mass < rule.least) found[band].push_back(g.active.nodes[a]);
    }
  });
  std::vector<std::uint32_t> all;
  for (const auto& of_band : found) all.insert(all.end(), of_band.begin(), of_band.end());
  std::sort(all.begin(), all.end());
  small.pair_up(g, rule, all);
}

Vec2 working_velocity(const GridState& g, std::size_t n, bool strained) {
  const Node& node = g.node[n];
  const Vec2 after = strained ? g.strain_velocity(n) : Vec2(node.nx, node.ny);
  return {node.held_x ? after.x() : 0.5 * (node.vx + after.x()), node.held_y ? after.y() : 0.5 * (node.vy + after.y())};
}

Vec2 working_velocity_by_touch(const GridState& g, const TouchedNode& touched, bool strained) {
  const Node& node = g.node[touched.node];
  const Vec2 after = strained ? g.strain_velocity(touched.node) : Vec2(node.nx, node.ny);
  return 0.5 * (Vec2(touched.x, touched.y) + after) - working_velocity(g, touched.node, strained);
}

NodalWork nodal_work(const GridState& g, const std::vector<Reaction>& reactions, std::span<const TouchedNode> touched, double damping,
                     double dt, bool strained, int threads) {
  NodalWork work;
  for (const Reaction& r : reactions) {
    const Vec2 w = working_velocity(g, r.node, strained);
    const double by_wall = r.impulse_x * r.wall_x + r.impulse_y * r.wall_y;
    work.bodies += by_wall;
    work.contact += by_wall - (r.impulse_x * w.x() + r.impulse_y * w.y());
    const auto touch = std::lower_bound(touched.begin(), touched.end(), r.node, [](const TouchedNode& t, std::uint64_t n) { return t.node < n; });
    if (touch == touched.end() || touch->node != r.node) continue;
    const Vec2 more = working_velocity_by_touch(g, *touch, strained);
    work.contact -= r.impulse_x * more.x() + r.impulse_y * more.y();
  }
  for (const TouchedNode& touch : touched) {
    const Node& node = g.node[touch.node];
    if (!(node.mass > 0)) continue;
    const Vec2 more = working_velocity_by_touch(g, touch, strained);
    work.kinetic += node.mass * ((node.nx - node.vx) * more.x() + (node.ny - node.vy) * more.y());
    if (damping > 0) work.damping -= dt * damping_force(damping, node).dot(more);
  }
  std::vector<NodalWork> parts(node_parts(g));
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    NodalWork sum;
    for_nodes_ahead(
        g, {begin, end}, [&](std::uint32_t n) { __builtin_prefetch(&g.node[n]); },
        [&](std::uint32_t n) {
          const Node& node = g.node[n];
          const Vec2 w = working_velocity(g, n, strained);
          sum.kinetic += node.mass * ((node.nx - node.vx) * w.x() + (node.ny - node.vy) * w.y());
          if (damping > 0) sum.damping -= dt * damping_force(damping, node).dot(w);
        });
    parts[part] = sum;
  });
  for (const NodalWork& part : parts) {
    work.kinetic += part.kinetic;
    work.damping += part.damping;
  }
  return work;
}

NodalMotion nodal_motion(const GridState& g, double least) {
  NodalMotion out;
  for (const std::uint32_t n : g.active.nodes) {
    const Node& node = g.node[n];
    const double speed2 = node.nx * node.nx + node.ny * node.ny;
    out.kinetic += 0.5 * node.mass * speed2;
    if (node.mass > least * g.measure(n)) out.fastest2 = std::max(out.fastest2, speed2);
  }
  return out;
}

}  // namespace pivnp::mpm

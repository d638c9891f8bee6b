#include "mpm/step/momentum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

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

}  // namespace

void SmallMassNodes::find(const GridState& g, const Rule& rule) { pair_up(g, rule, g.active.nodes); }

void SmallMassNodes::pair_up(const GridState& g, const Rule& rule, const std::vector<std::uint32_t>& nodes) {
  pairs.clear();
  for (const std::uint32_t n : nodes) {
    if (!(g.node[n].mass < rule.least * g.measure(n))) continue;
    const Pair pair = rule.linear ? outward(g, n) : Pair{n, heaviest_around(g, n), heaviest_around(g, n)};
    if (g.node[pair.heavy].mass >= rule.least * g.measure(pair.heavy)) pairs.push_back(pair);
  }
}

void SmallMassNodes::join_momentum(GridState& g, double damping, double dt) const {
  // A node may have several small ones: first all are added up, then all are told.
  const auto add = [&](std::uint32_t to, double share, const Node& small) {
    Node& node = g.node[to];
    const double mass = node.mass + share * small.mass;
    const Vec2 damped = damping_force(damping, small);
    node.nx = (node.mass * node.nx + share * small.mass * small.vx + share * dt * (small.fx + damped.x())) / mass;
    node.ny = (node.mass * node.ny + share * small.mass * small.vy + share * dt * (small.fy + damped.y())) / mass;
    node.mass = mass;
  };
  std::vector<std::pair<double, double>> masses_before;
  for (const Pair& p : pairs) {
    masses_before.emplace_back(g.node[p.heavy].mass, g.node[p.beyond].mass);
    add(p.heavy, p.beyond == p.heavy ? 1 : 2, g.node[p.small]);
    if (p.beyond != p.heavy) add(p.beyond, -1, g.node[p.small]);
  }
  for (std::size_t k = pairs.size(); k-- > 0;) {
    Node &small = g.node[pairs[k].small], &heavy = g.node[pairs[k].heavy], &beyond = g.node[pairs[k].beyond];
    small.nx = 2 * heavy.nx - beyond.nx;
    small.ny = 2 * heavy.ny - beyond.ny;
    beyond.mass = masses_before[k].second;
    heavy.mass = masses_before[k].first;
  }
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

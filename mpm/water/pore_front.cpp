// Flow where pores are not full: the water's surface inside the soil. docs/theory/mpm_water.md#the-waters-surface-inside-the-soil.
//
// A point holds a share S of what fills its pores. Below 1 its potential falls by the height of the point, b, from full to dry:
//   e = rho g (y - b (1 - S)):
// the water of a point that the surface cuts stands at its potential, so that water at rest has the same everywhere. It conducts in
// proportion to S. Nodes see the mean by what is wet; what they lose is taken from what is wet, and what they gain goes to what
// their potential reaches.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_elements.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

namespace {

constexpr double full_but_for = 1e-12;  // of the pores
constexpr double off_edge = 1e-9;       // cells: so that every node of an element sees its points

// What a node at which water stands gives a point beside it that is not full, beyond what that takes by its wet share: by that alone,
// dry soil would stay dry. Over the volume, the rate in a cell and time.
template <class Point>
double drawn(const Point& at, int c, const PoreFrontNode& node) {
  if (!node.given || node.seeps) return 0;
  return at.w[c] * at.mobility * (at.reached(node.potential) - at.share) * std::max(0.0, node.potential - at.potential);
}

}  // namespace

// rho g b of a point, Pa.
double PoreWater::fringe(const Particles& p, std::size_t k, const Vec2& gravity) const {
  return options_.density_kg_m3 * -gravity.y() * std::sqrt(section(p, k, p.volume0[k] * p.J[k]));
}

double PoreWater::filled(const Particles& p, std::size_t k) const { return p.content[k] / pores_of(p, k, soil_of(p, k)); }

double PoreWater::potential_in_pores(const Particles& p, std::size_t k, double filled, const Vec2& gravity) const {
  const double beyond = filled - 1;
  return (beyond < 0 ? fringe(p, k, gravity) : options_.bulk_modulus_pa) * beyond - head({p.x[k], p.y[k]}, gravity);
}

bool PoreWater::has_front(const Particles& p, const Vec2& gravity, int threads) const {
  if (!sees_air(gravity)) return false;
  std::atomic<bool> found = false;
  for (const Particles::Body& body : p.bodies) {
    if (!soils_[std::size_t(body.material)].holds_water()) continue;
    for_each(body.end - body.begin, threads, [&](std::size_t k) {
      const std::size_t n = body.begin + k;
      if (p.cell[n] != Particles::ended && filled(p, n) < 1 - full_but_for) found.store(true, std::memory_order_relaxed);
    });
  }
  return found;
}

bool PoreWater::surface_may_move(const Particles& p) const {
  if (imposed()) return false;
  if (boundaries_.any_level() || level_moves()) return true;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (soil_of(p, k).holds_water() && filled(p, k) < 1 - full_but_for) return true;
  return false;
}

PoreWater::FrontPoint PoreWater::front_point(const Particles& p, const GridState& g, std::size_t k, const Vec2& gravity) const {
  const InElement in = element_of(p, g, k);
  const std::size_t row = std::size_t(g.grid.nx);
  const double s = std::clamp(in.s, off_edge, 1 - off_edge), t = std::clamp(in.t, off_edge, 1 - off_edge);
  // As they were before the last strain: what of it no node sees must not drive water, which would push against nothing.
  const double height = fringe(p, k, gravity), filled = p.content[k] / std::max(least_pores, p.J_flow[k] - (1 - soil_of(p, k).porosity));
  return {{in.node, in.node + 1, in.node + row, in.node + row + 1},
          {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t}, s, t,
          p.volume0[k] * p.J[k], std::clamp(filled, 0.0, 1.0), potential_in_pores(p, k, filled, gravity),
          -height - head({p.x[k], p.y[k]}, gravity), height, mobility_of(p, k), 1 - p.J_flow[k] / p.J[k]};
}

// What a point's potential lacks to the field of the nodes around. (It is brought there by the share of it that is wet: by more, the few
// wet points beside dry ones would be drawn on faster than steps allow. What is dry fills by flow.)
double PoreWater::lack_in_front(const FrontPoint& at) const {
  double spanned = 0, weight = 0;
  for (int c = 0; c < 4; ++c)
    if (front_[at.at[c]].known()) {
      spanned += at.w[c] * front_[at.at[c]].potential;
      weight += at.w[c];
    }
  return weight > 0 ? spanned / weight - at.potential : 0;
}

PoreFlow PoreWater::flow_with_front(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                                    int threads) {
  front_.resize(g.arrays.pores.size());
  PoreFlow sums = fill_through_tractions(p, tractions, gravity, time, dt);
  map_front(p, g, tractions, gravity, time, threads);
  give_front(g, gravity, time, threads);
  smooth_front(g, &PoreFrontNode::strained, &PoreFrontNode::change, threads);
  add_front(p, g, gravity, threads);
  sums.add(change_front(g, time, dt, threads));
  smooth_front(g, &PoreFrontNode::unseen, &PoreFrontNode::restore, threads);
  sums.add(change_behind_front(p, g, gravity, dt, threads));
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { front_[n] = {}; });
  follow_porosity(p, threads);
  return sums;
}

std::vector<Vec2> PoreWater::flow_in_front(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time,
                                           int threads) {
  front_.resize(g.arrays.pores.size());
  map_front(p, g, tractions, gravity, time, threads);
  give_front(g, gravity, time, threads);
  std::vector<Vec2> flow(p.size(), Vec2::Zero());
  for_flowing(g, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      if (flows(p, k)) flow[k] = darcy_in_front(front_point(p, g, k, gravity), g);
    });
  });
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { front_[n] = {}; });
  return flow;
}

void PoreWater::map_front(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads) {
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const FrontPoint at = front_point(p, g, k, gravity);
      const Traction* load = tractions.of(p.index[k]);
      if (load && time < load->until)
        for (const std::size_t n : at.at) front_[n].loaded = std::max(front_[n].loaded, std::uint16_t(load->boundary + 1));
      front_[at.at[0]].holds = true;
      if (!flows(p, k)) return;
      for (int c = 0; c < 4; ++c) {
        PoreFrontNode& node = front_[at.at[c]];
        const double all = at.w[c] * at.volume, wet = all * at.share;
        node.all += all;
        node.wet += wet;
        node.potential += wet * at.potential;
        node.strained += wet * at.strain;
      }
    });
  });
}

std::optional<PoreWater::Opening> PoreWater::opening(const GridState& g, std::size_t n, const Vec2& gravity, double time) const {
  const PoreCondition* condition = boundaries_.at(n, time);
  if (!condition) {
    if (!at_surface(g, n, front_[n].all, time, [this](std::size_t element) { return front_[element].holds; })) return std::nullopt;
    if (front_[n].loaded > 0) condition = &boundaries_.of_boundary(std::size_t(front_[n].loaded - 1));
  }
  if (condition && !condition->gives_pressure()) return std::nullopt;
  const Vec2 x = g.position(n);
  const double pressure = condition ? given_pressure(*condition, x, gravity) : outside_pressure(x, gravity);
  return Opening{pressure, pressure > 0 || (condition && condition->kind == PoreCondition::pressure)};
}

// Water stands at the surfaces below a level; above it, it seeps out where it would stand higher.
void PoreWater::give_front(const GridState& g, const Vec2& gravity, double time, int threads) {
  for_each(g.active.nodes.size(), threads, [&](std::size_t a) {
    const std::size_t n = g.active.nodes[a];
    PoreFrontNode& node = front_[n];
    if (!(node.all > 0)) return;
    if (node.wet > 0) {
      node.potential /= node.wet;
      node.strained /= node.wet;
    }
    const std::optional<Opening> open = opening(g, n, gravity, time);
    if (!open) return;
    const double height = -head(g.position(n), gravity);
    node.seeps = !open->stands && node.wet > 0 && node.potential > height;
    node.given = open->stands || node.seeps;
    if (node.given) node.potential = open->pressure + height;
  });
}

// (1, 2, 1)/4 along each axis, as what nodes exchange with their neighbours through the smaller of what is wet around them.
void PoreWater::smooth_front(const GridState& g, double PoreFrontNode::*value, double PoreFrontNode::*scratch, int threads) {
  const auto along = [&](std::size_t step, double PoreFrontNode::*from, double PoreFrontNode::*to) {
    for_each(g.active.nodes.size(), threads, [&](std::size_t a) {
      const std::size_t n = g.active.nodes[a];
      PoreFrontNode& node = front_[n];
      double gain = 0;
      const auto take = [&](const PoreFrontNode& other) { gain += std::min(node.wet, other.wet) * (other.*from - node.*from); };
      if (n >= step) take(front_[n - step]);
      if (n + step < front_.size()) take(front_[n + step]);
      node.*to = node.*from + (node.wet > 0 ? 0.25 * gain / node.wet : 0.0);
    });
  };
  along(1, value, scratch);
  along(std::size_t(g.grid.nx), scratch, value);
}

Vec2 PoreWater::darcy_in_front(const FrontPoint& at, const GridState& g) const {
  double e[4];
  for (int c = 0; c < 4; ++c) e[c] = front_[at.at[c]].known() ? front_[at.at[c]].potential : at.potential;
  return -at.mobility * at.share * Vec2(((1 - at.t) * (e[1] - e[0]) + at.t * (e[3] - e[2])) * g.per_hx,
                                        ((1 - at.s) * (e[2] - e[0]) + at.s * (e[3] - e[1])) * g.per_hy);
}

void PoreWater::add_front(const Particles& p, GridState& g, const Vec2& gravity, int threads) {
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      if (!flows(p, k)) return;
      const FrontPoint at = front_point(p, g, k, gravity);
      const Vec2 q = at.volume * darcy_in_front(at, g);
      const double qx = q.x() * g.per_hx, qy = q.y() * g.per_hy;
      const double inflow[4] = {-qx * (1 - at.t) - qy * (1 - at.s), qx * (1 - at.t) - qy * at.s, -qx * at.t + qy * (1 - at.s),
                                qx * at.t + qy * at.s};
      double strained = 0, known = 0;
      const double lack = lack_in_front(at);
      for (int c = 0; c < 4; ++c) {
        strained += at.w[c] * front_[at.at[c]].strained;
        if (front_[at.at[c]].known()) known += at.w[c];
      }
      for (int c = 0; c < 4; ++c) {
        PoreFrontNode& node = front_[at.at[c]];
        node.inflow += inflow[c];
        node.unseen += at.w[c] * at.volume * at.share * (at.strain - strained);
        node.room += at.w[c] * at.volume * (node.known() ? at.reached(node.potential) : at.share);
        if (node.known()) node.restore += at.w[c] / known * at.volume * at.mobility * at.share * lack;
        node.restore += at.volume * drawn(at, c, node);
      }
    });
  });
}

PoreFlow PoreWater::change_front(const GridState& g, double time, double dt, int threads) {
  const double rate = rate_in_cell(g);
  std::vector<PoreFlow> parts(node_parts(g));
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    PoreFlow sum;
    for (std::size_t a = begin; a < end; ++a) {
      const std::size_t n = g.active.nodes[a];
      PoreFrontNode& node = front_[n];
      node.change = 0;
      if (!(node.all > 0)) continue;
      const double by_points = dt * rate * node.restore;
      double through = node.given ? by_points - dt * node.inflow : 0;
      if (!node.given || (node.seeps && through > 0)) {
        through = dt * flux_into(g, n, time, [this](std::ptrdiff_t element) { return element >= 0 && front_[std::size_t(element)].holds; });
        const double gain = dt * node.inflow + through - by_points;
        if (through > 0 && !(node.room > 0)) node.room = node.all, node.seeps = true;  // rain on what is dry
        const double volume = gain > 0 ? node.room : node.wet;
        node.change = volume > 0 ? gain / volume : 0;
      }
      if (node.wet > 0) node.unseen /= node.wet;
      sum.add({through, through * node.potential, through * node.potential});
    }
    parts[part] = sum;
  });
  PoreFlow all;
  for (const PoreFlow& part : parts) all.add(part);
  return all;
}

// Skeleton whose pores fill for the first time shrinks: held where it is, it loses the stress of that.
double PoreWater::collapse(Particles& p, std::size_t k, const PoreSoil& soil) const {
  const double more = std::min(1.0, filled(p, k)) - p.wetted[k];
  if (!(soil.collapse > 0 && more > 0)) return 0;
  p.wetted[k] += more;
  const double strain = soil.collapse * more, change = soil.bulk_modulus * strain;
  const double mean = (p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3 + 0.5 * change;
  for (Array* stress : {&p.tau_xx, &p.tau_yy, &p.tau_zz}) (*stress)[k] += change;
  return -p.volume0[k] * strain * mean;
}

// What the water lost of its potential energy, and the skeleton by collapse.
PoreFlow PoreWater::change_behind_front(Particles& p, GridState& g, const Vec2& gravity, double dt, int threads) {
  const double rate_dt = rate_in_cell(g) * dt;
  std::vector<PoreFlow> parts(g.active.flowing.size());
  for_flowing(g, threads, [&](Range range, std::size_t piece) {
    PoreFlow sum;
    for_points_of(g, range, [&](std::uint32_t k) {
      if (flows(p, k)) {
        const FrontPoint at = front_point(p, g, k, gravity);
        double fed = 0, flowed = rate_dt * at.mobility * at.share * lack_in_front(at);
        for (int c = 0; c < 4; ++c) {
          const PoreFrontNode& node = front_[at.at[c]];
          fed += at.w[c] * (node.strained + node.unseen);
          const double reach = node.change > 0 ? (node.known() ? at.reached(node.potential) : node.seeps ? 1 : at.share) : at.share;
          flowed += at.w[c] * reach * node.change + rate_dt * drawn(at, c, node);
        }
        p.content[k] += p.J[k] * at.share * (at.strain - fed);
        const double more = p.J[k] * flowed;
        p.content[k] += more;
        sum.darcy -= p.volume0[k] * more * 0.5 * (at.potential + potential_in_pores(p, k, filled(p, k), gravity));
        if (!p.wetted.empty()) sum.collapsed += collapse(p, k, soil_of(p, k));
      }
      refresh_point(p, k, soil_of(p, k), gravity);
    });
    parts[piece] = sum;
  });
  PoreFlow all;
  for (const PoreFlow& part : parts) all.add(part);
  return all;
}

}  // namespace pivnp::mpm

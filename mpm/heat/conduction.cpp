#include "mpm/heat/conduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_elements.hpp"

namespace pivnp::mpm {

namespace {

// Van Leer's limiter: what the half of a step to the next node adds to the upstream one's value.
double half_step(double behind, double ahead) {
  const double product = behind * ahead;
  return product > 0 ? product / (behind + ahead) : 0;
}

}  // namespace

Conduction::Conduction(const std::vector<HeatSoil>& soils, const ParticleSet& particles, GridState& g, HeatBoundaries boundaries,
                       const TiedSides& ties)
    : soils_(&soils),
      set_(&particles),
      boundaries_(std::move(boundaries)),
      ties_(&ties),
      nodes_(g.arrays.heat.data() + std::size_t(g.grid.nx) + 8),
      row_(g.grid.nx),
      is_given_(g.grid.node_count(), 0) {
  double most = 0;
  for (const HeatSoil& soil : soils) most = std::max(most, soil.diffusivity());
  least_diffusivity_ = most > 0 ? 1e-9 * most : 1e-12;
}

double Conduction::longest_step(const GridState& g) const {
  double most = 0;
  for (const HeatSoil& soil : *soils_) most = std::max(most, soil.diffusivity());
  return most > 0 ? 1 / (most * rate_in_cell(g)) : std::numeric_limits<double>::infinity();
}

Conduction::Sums Conduction::conduct(const Particles& p, GridState& g, const PoreWater* water, double carried_capacity,
                                     double darcy, const Vec2& gravity, double time, double dt,
                                     std::vector<double>& rise, int threads) {
  Sums sums;
  const double rate = rate_in_cell(g) * dt;
  map(p, g, threads);
  join_ties(time);
  take_means(g, threads);
  sums.inflow += give_temperatures(g, rate, time, dt);
  add_edges(g, water, carried_capacity, rate, dt, threads, sums);
  if (water && darcy != 0) give_darcy(p, g, *water, darcy, gravity, rise, threads, sums);
  for (const Joined& joined : joined_) {
    HeatNode &a = nodes_[joined.node[0]], &b = nodes_[joined.node[1]];
    if (is_given_[joined.node[0]]) continue;
    a.gain = b.gain = a.gain + b.gain;
    a.evened = b.evened = a.evened + b.evened;
  }
  for_nodes(g, threads, [&](Node&, std::uint32_t n) {
    HeatNode& node = nodes_[n];
    if (!(node.capacity > 0)) return;
    const bool given = is_given_[n];
    node.change = given ? 0 : node.gain / node.capacity;
    node.evened = node.temperature + (given ? 0 : node.evened / (rate * node.diffusing));
  });
  for_pieces(g, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const InElement in = element_of(p, g, k);
      const HeatNode *low = nodes_ + in.node, *high = low + row_;
      const double w[4] = {(1 - in.s) * (1 - in.t), in.s * (1 - in.t), (1 - in.s) * in.t, in.s * in.t};
      const double change = w[0] * low[0].change + w[1] * low[1].change + w[2] * high[0].change + w[3] * high[1].change;
      const double evened = w[0] * low[0].evened + w[1] * low[1].evened + w[2] * high[0].evened + w[3] * high[1].evened;
      rise[k] += change + rate * diffusivity_of(soil_of(p, k)) * (evened - p.temperature[k]);
    });
  });
  for (const std::uint32_t n : given_) is_given_[n] = 0;
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { nodes_[n] = {}; });
  return sums;
}

void Conduction::map(const Particles& p, GridState& g, int threads) {
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const HeatSoil& soil = soil_of(p, k);
      const InElement in = element_of(p, g, k);
      const double capacity = p.volume0[k] * soil.capacity, volume = p.volume0[k] * p.J[k], diffusivity = diffusivity_of(soil);
      const auto add = [&](HeatNode& node, double w) {
        const double c = w * capacity;
        node.capacity += c;
        node.diffusing += c * diffusivity;
        node.heat += c * diffusivity * p.temperature[k];
      };
      HeatNode *low = nodes_ + in.node, *high = low + row_;
      add(low[0], (1 - in.s) * (1 - in.t));
      add(low[1], in.s * (1 - in.t));
      add(high[0], (1 - in.s) * in.t);
      add(high[1], in.s * in.t);
      low->inside += volume;
      low->resisting += soil.conductivity > 0 ? volume / soil.conductivity : std::numeric_limits<double>::infinity();
      low->contained += capacity;
      low->along_x += capacity * in.s * (1 - in.s);
      low->along_y += capacity * in.t * (1 - in.t);
    });
  });
}

// Tied nodes are one node: each has the sums of both. Edges and elements are one side's alone.
void Conduction::join_ties(double time) {
  joined_.clear();
  for (const TiedSides::Tie& tie : ties_->ties()) {
    HeatNode &a = nodes_[tie.node[0]], &b = nodes_[tie.node[1]];
    if (time >= tie.until || !(a.capacity > 0 && b.capacity > 0)) continue;
    const double capacity = a.capacity + b.capacity;
    const double both = a.diffusing + b.diffusing;
    joined_.push_back({{tie.node[0], tie.node[1]}, {a.diffusing / both, b.diffusing / both}, {a.heat / a.diffusing, b.heat / b.diffusing}});
    a.capacity = b.capacity = capacity;
    a.heat = b.heat = a.heat + b.heat;
    a.diffusing = b.diffusing = a.diffusing + b.diffusing;
  }
}

void Conduction::take_means(const GridState& g, int threads) {
  for_each(g.active.nodes.size(), threads, [&](std::size_t a) {
    HeatNode& node = nodes_[g.active.nodes[a]];
    if (!(node.capacity > 0)) return;
    node.temperature = node.heat / node.diffusing;
  });
}

// What the boundaries give: temperatures, which take the place of the mean, and heat. Returns what came into the nodes by flux, and
// into the points that are brought to a given temperature.
double Conduction::give_temperatures(const GridState& g, double rate, double time, double dt) {
  double inflow = 0;
  given_.clear();
  std::uint32_t last = std::uint32_t(-1);
  for (const HeatBoundaries::AtNode& at : boundaries_.nodes()) {
    if (time >= at.until || at.node == last) continue;
    last = at.node;
    for (int field = 0; field < g.velocity_fields; ++field) {
      const auto n = std::uint32_t(at.node + std::size_t(field) * g.field_nodes());
      HeatNode& node = nodes_[n];
      if (!(node.capacity > 0)) continue;
      if (at.condition.kind == HeatCondition::temperature) {
        double mean = node.temperature, share = 1;
        for (const Joined& joined : joined_)
          for (const int side : {0, 1})
            if (joined.node[side] == n) mean = joined.mean[side], share = joined.share[side];
        given_.push_back(n);
        node.temperature = at.condition.value;
        is_given_[n] = 1;
        inflow += rate * share * node.diffusing * (node.temperature - mean);
        continue;
      }
      const auto beside = [&](int left, int below) { return nodes_[std::ptrdiff_t(n) - left - below * row_].inside > 0 ? 0.5 : 0.0; };
      const double hx = g.grid.spacing.x(), hy = g.grid.spacing.y();
      const double length = at.side == wall_left    ? (beside(0, 0) + beside(0, 1)) * hy
                            : at.side == wall_right ? (beside(1, 0) + beside(1, 1)) * hy
                            : at.side == wall_down  ? (beside(0, 0) + beside(1, 0)) * hx
                                                    : (beside(0, 1) + beside(1, 1)) * hx;
      const double heat = dt * length * (at.condition.kind == HeatCondition::flux ? at.condition.value
                                                                                 : at.condition.transfer * (at.condition.value - node.temperature));
      node.gain += heat;
      inflow += heat;
    }
  }
  return inflow;
}

// Of the edge to the right or up: heat for a degree, and what the points beside it pass on at the rate of a cell.
Conduction::Edge Conduction::edge(const GridState& g, std::size_t n, bool along_x, double rate, double dt) const {
  const HeatNode &here = nodes_[n], &beside = *(nodes_ + n - (along_x ? row_ : 1));
  const double through = dt * (along_x ? g.per_hx * g.per_hx : g.per_hy * g.per_hy);
  const auto of = [&](const HeatNode& e) {
    if (!(e.inside > 0)) return Edge{};
    const double conducting = e.inside * (e.inside / e.resisting);  // in series: the harmonic mean
    return Edge{0.5 * through * conducting, 0.5 * rate * conducting / e.contained * (along_x ? e.along_x : e.along_y)};
  };
  const Edge a = of(here), b = of(beside);
  return {a.conducts + b.conducts, a.passed + b.passed};
}

void Conduction::add_edges(const GridState& g, const PoreWater* water, double carried_capacity, double rate, double dt, int threads,
                           Sums& sums) {
  std::vector<Sums> parts(node_parts(g));
  const auto there = [&](std::size_t n) { return nodes_[n].capacity > 0; };
  const auto row = std::size_t(row_);
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    Sums& sum = parts[part];
    // What comes into node n from a neighbour through the edge that begins at `first`.
    const auto from = [&](std::size_t n, std::size_t other, std::size_t first, bool along_x) {
      if (!there(other)) return 0.0;
      const double dT = nodes_[other].temperature - nodes_[n].temperature;
      const Edge through = edge(g, first, along_x, rate, dt);
      double heat = through.conducts * dT;
      const double passed = through.passed * dT;
      if (is_given_[n]) {
        if (!is_given_[other]) sum.inflow -= heat - passed;  // it comes from outside
        return 0.0;
      }
      nodes_[n].evened -= passed;
      if (!water) return heat;
      const PoreWater::EdgeFlow q = water->edge_flow(g, first);
      const double into = (along_x ? q.x : q.y) * (other == first ? 1 : -1);
      const std::size_t step = along_x ? 1 : row, up = into > 0 ? other : n, down = into > 0 ? n : other;
      const std::size_t behind = up > down ? up + step : up - step;
      const double ahead_by = nodes_[down].temperature - nodes_[up].temperature;
      const bool joined = nodes_[std::min(up, behind)].inside > 0 || (nodes_ + std::min(up, behind) - (along_x ? row_ : 1))->inside > 0;
      const double behind_by = joined && there(behind) ? nodes_[up].temperature - nodes_[behind].temperature : 0;
      const double face = nodes_[up].temperature + half_step(behind_by, ahead_by);
      const double carried = carried_capacity * dt * into * (face - nodes_[n].temperature);
      sum.inflow += carried;
      if (nodes_[n].contained > 0) sum.crossing = std::max(sum.crossing, carried_capacity * std::abs(into) / nodes_[n].capacity);
      return heat + carried;
    };
    for (std::size_t a = begin; a < end; ++a) {
      const std::size_t n = g.active.nodes[a];
      if (!there(n)) continue;
      nodes_[n].gain += (from(n, n + 1, n, true) + from(n, n - 1, n - 1, true)) + (from(n, n + row, n, false) + from(n, n - row, n - row, false));
    }
  });
  for (const Sums& part : parts) {
    sums.inflow += part.inflow;
    sums.crossing = std::max(sums.crossing, part.crossing);
  }
}

// What the flow dissipated becomes heat in proportion to what it dissipates now: of each edge half at either end, and
// at the points where their water evens out in a cell. At a given temperature it leaves at once.
void Conduction::give_darcy(const Particles& p, GridState& g, const PoreWater& water, double darcy, const Vec2& gravity,
                            std::vector<double>& rise, int threads, Sums& sums) {
  const auto row = std::size_t(row_);
  std::vector<double> of_nodes(node_parts(g), 0.0), of_points;
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      const std::size_t n = g.active.nodes[a];
      const auto through = [&](std::size_t other, std::size_t first, bool along_x) {
        if (!(nodes_[other].capacity > 0)) return 0.0;
        const PoreWater::EdgeFlow q = water.edge_flow(g, first);
        return 0.5 * (along_x ? q.heat_x : q.heat_y);
      };
      double& flow = nodes_[n].heat;  // (its heat has been asked for)
      flow = 0;
      if (nodes_[n].capacity > 0)
        flow = (through(n + 1, n, true) + through(n - 1, n - 1, true)) +
               (through(n + row, n, false) + through(n - row, n - row, false));
      of_nodes[part] += flow;
    }
  });
  evening_.assign(p.size(), 0.0);
  of_points.assign(g.active.pieces.size(), 0.0);
  for_pieces(g, threads, [&](Range range, std::size_t piece) {
    for_points_of(g, range,
                  [&](std::uint32_t k) { of_points[piece] += evening_[k] = water.evening(p, g, k, gravity); });
  });
  double all = 0;
  for (const double part : of_nodes) all += part;
  for (const double part : of_points) all += part;
  if (!(all > 0)) return;
  const double share = darcy / all;
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { nodes_[n].gain += share * nodes_[n].heat; });
  for (const std::uint32_t n : given_) sums.inflow -= share * nodes_[n].heat;
  for_pieces(g, threads, [&](Range range, std::size_t) {
    for_points_of(g, range,
                  [&](std::uint32_t k) { rise[k] += share * evening_[k] / (p.volume0[k] * soil_of(p, k).capacity); });
  });
  sums.darcy = darcy;
}

}  // namespace pivnp::mpm

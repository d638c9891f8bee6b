// Darcy's flow of a step, by hats between nodes.
#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

namespace {

constexpr double least_share = 0.25;  // of a node's volume inside the material: with less its potential is that of a surface

// The element between nodes that a point is in: its lower left node, and the point's place from there, in cells.
struct InElement {
  std::size_t node;
  double s, t;
};

InElement element_of(const Particles& p, const GridState& g, std::size_t k) {
  const Vec2 at = g.natural(p, k);
  const auto cell = std::size_t(p.cell[k]);
  if (!g.centred) return {cell, std::clamp(at.x(), 0.0, 1.0), std::clamp(at.y(), 0.0, 1.0)};
  const std::size_t left = at.x() < 0, below = at.y() < 0, row = std::size_t(g.grid.nx);
  return {cell + row + 1 - left - below * row, at.x() + double(left), at.y() + double(below)};
}

// Rate at which a cell's own water evens out, over the diffusivity, 1/m^2.
double rate_in_cell(const GridState& g) { return 2 * (g.per_hx * g.per_hx + g.per_hy * g.per_hy); }

// Calls each(k) for the points of some occupied cells.
template <class Each>
void for_points_of(const GridState& g, Range cells, Each&& each) {
  for (std::uint32_t q = g.cells.begin[cells.begin]; q < g.cells.begin[cells.end]; ++q) each(g.cells.order[q]);
}

}  // namespace

// The element's nodes, with their hats at the point.
struct PoreWater::Hats {
  std::size_t at[4];
  double w[4];

  Hats(const InElement& e, std::size_t row)
      : at{e.node, e.node + 1, e.node + row, e.node + row + 1},
        w{(1 - e.s) * (1 - e.t), e.s * (1 - e.t), (1 - e.s) * e.t, e.s * e.t} {}
};

PoreFlow PoreWater::flow(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                         int threads) {
  map_potential(p, g, tractions, gravity, time, threads);
  tie_means(g, gravity, time);
  give_potentials(g, gravity, time, threads);
  tie_given(g, gravity);
  smooth(g, &PoreNode::strained, &PoreNode::change, threads);
  add_fluxes(p, g, gravity, threads);
  PoreFlow sums = change_nodes(g, time, dt, threads);
  sums.add(tie_changes(g, gravity));
  smooth(g, &PoreNode::unseen, &PoreNode::restore, threads);
  sums.add(change_points(p, g, tractions, gravity, time, dt, threads));
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { node_[n] = PoreNode{}; });
  return sums;
}

void PoreWater::map_potential(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads) {
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const InElement in = element_of(p, g, k);
      const Hats hats(in, std::size_t(g.grid.nx));
      const Traction* load = tractions.of(p.index[k]);
      if (load && time < load->until)
        for (const std::size_t n : hats.at) node_[n].loaded = std::max(node_[n].loaded, std::uint16_t(load->boundary + 1));
      if (!flows(p, k)) {
        if (!soil_of(p, k).has_pores()) node_[in.node].cell |= holds_solid;
        return;
      }
      node_[in.node].cell |= holds_water;
      const double volume = p.volume0[k] * p.J[k], e = p.pressure[k] - head({p.x[k], p.y[k]}, gravity);
      const double strain = strain_of(p, k);
      for (int c = 0; c < 4; ++c) {
        PoreNode& node = node_[hats.at[c]];
        const double share = hats.w[c] * volume;
        node.volume += share;
        node.potential += share * e;
        node.strained += share * strain;
      }
    });
  });
}

// An element beside a node counts unless it is beyond the domain, behind a wall along the grid, or sealed; the material's surface is
// where one is empty.
void PoreWater::give_potentials(const GridState& g, const Vec2& gravity, double time, int threads) {
  const auto row = std::size_t(g.grid.nx);
  const double per_volume = g.per_hx * g.per_hy, hy = g.grid.spacing.y();
  for_each(g.active.nodes.size(), threads, [&](std::size_t a) {
    const std::size_t n = g.active.nodes[a];
    PoreNode& node = node_[n];
    if (!(node.volume > 0)) return;
    node.potential /= node.volume;
    node.strained /= node.volume;
    const Vec2 x = g.position(n);
    const PoreCondition* condition = boundaries_.at(n, time);
    bool surface = false;
    if (!condition) {
      const int i = int(n % row), j = int(n % g.field_nodes() / row);
      const std::uint8_t walls = g.walls[n];
      int open = 0;
      for (int c = 0; c < 4; ++c) {
        const int left = 1 - c % 2, below = 1 - c / 2, ei = i - left, ej = j - below;
        if (ei < first_i_ || ei >= last_i_ || ej < first_j_ || ej >= last_j_) continue;
        if (walls & ((left ? wall_left : wall_right) | (below ? wall_down : wall_up))) continue;
        const std::size_t element = n - std::size_t(left) - std::size_t(below) * row;
        const bool empty = node_[element].cell == 0;
        if (empty && sealed(g, element, time)) continue;
        ++open;
        surface = surface || empty;
      }
      surface = surface || node.volume * per_volume < least_share * 0.25 * open;
      if (surface && node.loaded > 0) condition = &boundaries_.of_boundary(std::size_t(node.loaded - 1));
    }
    if (condition) {
      if (condition->kind == PoreCondition::pressure || condition->kind == PoreCondition::drained) {
        node.given = true;
        const double pressure = condition->kind == PoreCondition::pressure ? condition->value : outside_pressure(x, gravity);
        node.potential = pressure - head(x, gravity);
      }
    } else if (surface) {
      // With a level, the water's surface is at it, and not at the node that is next above.
      node.given = true;
      node.potential = level_ ? options_.density_kg_m3 * -gravity.y() * (std::max(0.0, x.y() - hy - *level_) + *level_ - reference_.y())
                              : -head(x, gravity);
    }
  });
}

// (1, 2, 1)/4 along each axis, as what nodes exchange with their neighbours through the smaller of their volumes: the sum of V
// times the value stays, and what alternates from node to node goes. Without it two waves of cells would pass that give no force.
void PoreWater::smooth(const GridState& g, double PoreNode::*value, double PoreNode::*scratch, int threads) {
  const auto along = [&](std::size_t step, double PoreNode::*from, double PoreNode::*to) {
    for_each(g.active.nodes.size(), threads, [&](std::size_t a) {
      const std::size_t n = g.active.nodes[a];
      PoreNode& node = node_[n];
      double gain = 0;
      const auto take = [&](const PoreNode& other) { gain += std::min(node.volume, other.volume) * (other.*from - node.*from); };
      if (n >= step) take(node_[n - step]);
      if (n + step < node_.size()) take(node_[n + step]);
      node.*to = node.*from + (node.volume > 0 ? 0.25 * gain / node.volume : 0.0);
    });
  };
  along(1, value, scratch);
  tie_gains(g, 1, value, scratch);
  along(std::size_t(g.grid.nx), scratch, value);
  tie_gains(g, std::size_t(g.grid.nx), scratch, value);
}

// What a point's potential lacks to the field that the nodes span.
double PoreWater::lack_of(const Particles& p, std::size_t k, const Hats& hats, const Vec2& gravity) const {
  double spanned = 0;
  for (int c = 0; c < 4; ++c) spanned += hats.w[c] * node_[hats.at[c]].potential;
  return spanned - (p.pressure[k] - head({p.x[k], p.y[k]}, gravity));
}

// A point's strain beyond the mean around it, which the nodes do not see.
double PoreWater::unseen_strain(const Particles& p, std::size_t k, const Hats& hats) const {
  double mean = 0;
  for (int c = 0; c < 4; ++c) mean += hats.w[c] * node_[hats.at[c]].strained;
  return strain_of(p, k) - mean;
}

void PoreWater::add_fluxes(Particles& p, GridState& g, const Vec2& gravity, int threads) {
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      if (!flows(p, k)) return;
      const InElement in = element_of(p, g, k);
      const Hats hats(in, std::size_t(g.grid.nx));
      double e[4];
      for (int c = 0; c < 4; ++c) e[c] = node_[hats.at[c]].potential;
      const double along_x = ((1 - in.t) * (e[1] - e[0]) + in.t * (e[3] - e[2])) * g.per_hx;
      const double along_y = ((1 - in.s) * (e[2] - e[0]) + in.s * (e[3] - e[1])) * g.per_hy;
      const double volume = p.volume0[k] * p.J[k], mobility = mobility_of(p, k) * volume;
      p.flow_x[k] = -mobility_of(p, k) * along_x;
      p.flow_y[k] = -mobility_of(p, k) * along_y;
      const double qx = volume * p.flow_x[k] * g.per_hx, qy = volume * p.flow_y[k] * g.per_hy;
      const double lack = lack_of(p, k, hats, gravity);
      const double unseen = volume * unseen_strain(p, k, hats);
      const double inflow[4] = {-qx * (1 - in.t) - qy * (1 - in.s), qx * (1 - in.t) - qy * in.s, -qx * in.t + qy * (1 - in.s),
                                qx * in.t + qy * in.s};
      for (int c = 0; c < 4; ++c) {
        PoreNode& node = node_[hats.at[c]];
        node.inflow += inflow[c];
        node.restore += hats.w[c] * mobility * lack;
        node.unseen += hats.w[c] * unseen;
      }
    });
  });
}

double PoreWater::length_along(const GridState& g, std::size_t n, std::uint8_t side) const {
  const int i = int(n % std::size_t(g.grid.nx)), j = int(n / std::size_t(g.grid.nx));
  const auto beside = [&](int left, int below) {
    const bool inside = i >= left && j >= below;
    return inside && (node_[g.grid.node(i - left, j - below)].cell & holds_water) ? 0.5 : 0.0;
  };
  switch (side) {
    case wall_left: return (beside(0, 0) + beside(0, 1)) * g.grid.spacing.y();
    case wall_right: return (beside(1, 0) + beside(1, 1)) * g.grid.spacing.y();
    case wall_down: return (beside(0, 0) + beside(1, 0)) * g.grid.spacing.x();
    default: return (beside(0, 1) + beside(1, 1)) * g.grid.spacing.x();
  }
}

PoreFlow PoreWater::change_nodes(const GridState& g, double time, double dt, int threads) {
  const double rate = rate_in_cell(g);
  std::vector<PoreFlow> parts(node_parts(g));
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    PoreFlow sum;
    for (std::size_t a = begin; a < end; ++a) {
      const std::size_t n = g.active.nodes[a];
      PoreNode& node = node_[n];
      node.change = 0;
      if (!(node.volume > 0)) continue;
      double through = 0;  // volume of water through the boundary
      const double by_points = dt * rate * node.restore;  // what they take by themselves, at the rate of a cell
      if (node.given) {
        through = by_points - dt * node.inflow;
      } else {
        const PoreCondition* condition = boundaries_.at(n, time);
        if (condition && condition->kind == PoreCondition::flux)
          through = dt * condition->value * length_along(g, n, boundaries_.side(n, time));
        node.change = (dt * node.inflow + through - by_points) / node.volume;
      }
      node.unseen /= node.volume;
      sum.inflow += through;
      sum.external += through * node.potential;
    }
    parts[part] = sum;
  });
  PoreFlow all;
  for (const PoreFlow& part : parts) all.add(part);
  all.darcy = all.external;
  return all;
}

// Water that flows through the loaded face of a point, m^2/s.
double PoreWater::flux_of(const Particles& p, const Tractions& tractions, std::size_t k, double time) const {
  if (!boundaries_.any_flux_on_tractions()) return 0;
  const Traction* load = tractions.of(p.index[k]);
  if (!load || time >= load->until) return 0;
  const PoreCondition& condition = boundaries_.of_boundary(load->boundary);
  return condition.kind == PoreCondition::flux ? condition.value * load->face : 0;
}

// Beside what nodes pass on, points exchange what the nodes do not see, less the mean of that around them: fields of few waves
// stay (to the fourth order), and the means' weights conserve. Of the flow's energy, what was neither stored in the water nor lost
// at the boundaries is dissipated.
PoreFlow PoreWater::change_points(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                                  int threads) {
  const double rate_dt = rate_in_cell(g) * dt;
  std::vector<PoreFlow> parts(g.active.pieces.size());
  for_pieces(g, threads, [&](Range range, std::size_t piece) {
    PoreFlow sum;
    for_points_of(g, range, [&](std::uint32_t k) {
      const PoreSoil& soil = soil_of(p, k);
      if (flows(p, k)) {
        const Hats hats(element_of(p, g, k), std::size_t(g.grid.nx));
        const double by_cell = rate_dt * mobility_of(p, k) * lack_of(p, k, hats, gravity);
        double evened = unseen_strain(p, k, hats), flowed = by_cell;
        for (int c = 0; c < 4; ++c) {
          evened -= hats.w[c] * node_[hats.at[c]].unseen;
          flowed += hats.w[c] * node_[hats.at[c]].change;
        }
        p.content[k] += p.J[k] * evened;
        const double through = dt * flux_of(p, tractions, k, time), height = head({p.x[k], p.y[k]}, gravity);
        const double more = p.J[k] * flowed + through / p.volume0[k];
        const double pores = pores_of(p, k, soil), before = options_.bulk_modulus_pa * (p.content[k] / pores - 1);
        const double stored = p.volume0[k] * more * (before + 0.5 * options_.bulk_modulus_pa * more / pores);
        const double external = p.volume0[k] * more * height + through * (before - height);
        sum.inflow += through;
        sum.external += external + p.volume0[k] * p.J[k] * evened * height;
        sum.darcy += external - stored;
        p.content[k] += more;
      }
      refresh_point(p, k, soil, gravity);
    });
    parts[piece] = sum;
  });
  PoreFlow all;
  for (const PoreFlow& part : parts) all.add(part);
  return all;
}

}  // namespace pivnp::mpm

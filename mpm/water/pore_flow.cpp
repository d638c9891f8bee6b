// Darcy's flow of a step, by hats between nodes.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_borders.hpp"
#include "mpm/water/pore_elements.hpp"
#include "mpm/water/pore_water.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr double least_distance_inverse = 2;  // from a node to a surface in a cut element, in cells: nearer, it would shorten the step

// Calls sweep(nodes, size) for parts of the active nodes.
template <class Sweep>
void for_node_lists(const GridState& g, int threads, Sweep&& sweep) {
  for_node_parts(g, threads, [&](std::size_t, std::size_t begin, std::size_t end) { sweep(g.active.nodes.data() + begin, end - begin); });
}

}  // namespace

PoreFlow PoreWater::flow(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time,
                         double dt, int threads, std::vector<double>* state) {
  set_outside(p, gravity);
  if (state && has_front(p, gravity, threads))
    throw RunError("mpm: pores are no longer full, expected full pores with water.inertia");
  mix_at_borders(p, g, threads);
  if (has_front(p, gravity, threads)) return flow_with_front(p, g, tractions, gravity, time, dt, threads);
  PoreFlow sums;
  map_points(p, g, tractions, gravity, time, threads);
  take_means(g, gravity, time, dt, threads);
  take_flow_through_tractions(p, g, tractions, time, dt);
  const double rate = rate_in_cell(g) * dt;
  PoreFields f = field_;
  if (p.mobility.empty()) f.rate = nullptr;
  std::optional<StrainAtBorders> borders;
  const bool several = alike_.own && soils_.size() > 1;
  const std::vector<std::uint8_t> kinds = several ? kinds_of(soils_) : std::vector<std::uint8_t>();
  const auto kind = [&](std::uint32_t k) { return flows(p, k) ? kinds[std::size_t(set_->label[p.index[k]])] : std::uint8_t(0); };
  if (several) borders.emplace(p, g, f, soil_in_, kinds, kind, threads);
  if (borders && !borders->any()) borders.reset();
  if (borders) borders->part(f);
  if (threads <= 1 && joined_.empty() && !state && !borders) {
    exchange_row_by_row(g, f, rate);
    sums.add(at_given_nodes(rate));
  } else {
    for_node_lists(g, threads,
                   [&](const std::uint32_t* nodes, std::size_t size) { weigh_elements_lanes(f, nodes, size); });
    const auto smooth = [&] {
      for_node_lists(g, threads, [&](const std::uint32_t* nodes, std::size_t size) {
        smooth_pores_lanes(f, f.mean, f.even, nodes, size);
      });
      tie_smoothed(f.mean, f.even);
    };
    smooth();
    keep_means();
    for_node_lists(g, threads, [&](const std::uint32_t* nodes, std::size_t size) {
      exchange_pores_lanes(f, rate, alike_.mobility, nodes, size);
    });
    sums.add(at_given_nodes(rate));
    if (state) sums.add(push_flow(g, dt, *state));
    sums.add(tie_exchanged(g, gravity, rate));
    if (borders) borders->take(f);
    smooth();
    if (borders) borders->feed(p, g, kind, threads);
  }
  const PointView points = p.view();
  const PoreView pores = view(p, gravity);
  const CellView cells = g.view();
  std::vector<PoreChange> parts(g.active.flowing.size());
  for_flowing(g, threads, [&](Range range, std::size_t piece) {
    parts[piece] = change_points_lanes(g.centred, rate, points, pores, cells, f, range);
  });
  for (const PoreChange& part : parts) {
    sums.darcy += part.lost;
    sums.external += part.lifted;
  }
  mark_given(false);
  follow_porosity(p, threads);
  return sums;
}

// Weights, smoothing, exchange and smoothing again, each as soon as the rows beside are ready: while they are in the
// cache.
void PoreWater::exchange_row_by_row(const GridState& g, const PoreFields& f, double rate) const {
  const std::vector<std::uint32_t>& nodes = g.active.nodes;
  std::vector<std::size_t> rows = {0};
  while (rows.back() < nodes.size()) {
    const auto next = std::uint32_t((std::ptrdiff_t(nodes[rows.back()]) / f.row + 1) * f.row);
    rows.push_back(
        std::size_t(std::lower_bound(nodes.begin() + std::ptrdiff_t(rows.back()), nodes.end(), next) - nodes.begin()));
  }
  const auto in_row = [&](std::size_t row, auto&& sweep) {
    if (row + 1 < rows.size()) sweep(nodes.data() + rows[row], rows[row + 1] - rows[row]);
  };
  const auto smooth = [&](const std::uint32_t* first, std::size_t size) {
    smooth_pores_lanes(f, f.mean, f.even, first, size);
  };
  for (std::size_t row = 0; row < rows.size() + 1; ++row) {
    in_row(row, [&](const std::uint32_t* first, std::size_t size) { weigh_elements_lanes(f, first, size); });
    in_row(row, smooth);
    if (row >= 1)
      in_row(row - 1, [&](const std::uint32_t* first, std::size_t size) {
        exchange_pores_lanes(f, rate, alike_.mobility, first, size);
      });
    if (row >= 2) in_row(row - 2, smooth);
  }
}

std::vector<Vec2> PoreWater::flow_at_points(const Particles& p, GridState& g, const Tractions& tractions,
                                            const Vec2& gravity, double time, int threads,
                                            const std::vector<double>* state) {
  if (has_front(p, gravity, threads)) return flow_in_front(p, g, tractions, gravity, time, threads);
  map_points(p, g, tractions, gravity, time, threads);
  take_means(g, gravity, time, 0, threads);
  std::vector<Vec2> flow(p.size(), Vec2::Zero());
  for_flowing(g, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      if (!flows(p, k)) return;
      const InElement in = element_of(p, g, k);
      if (state && !state->empty()) {
        flow[k] = inert_flow(g, in.node, in.s, in.t, *state);
        return;
      }
      const double *low = field_.potential + in.node, *high = low + field_.row;
      flow[k] = -mobility_of(p, k) * Vec2(((1 - in.t) * (low[1] - low[0]) + in.t * (high[1] - high[0])) * g.per_hx,
                                          ((1 - in.s) * (high[0] - low[0]) + in.s * (high[1] - low[1])) * g.per_hy);
    });
  });
  mark_given(false);
  return flow;
}

PoreWater::EdgeFlow PoreWater::edge_flow(const GridState& g, std::size_t n) const {
  const auto conducting = [&](std::size_t element) {
    const PoreElement& e = sums_.element[element];
    return alike_.own ? e.conducting : alike_.mobility * e.inside;
  };
  const auto drop = [&](std::size_t next) {
    return field_.volume[n] > 0 && field_.volume[next] > 0 ? field_.potential[n] - field_.potential[next] : 0;
  };
  const auto row = std::size_t(field_.row);
  const double x = drop(n + 1), y = drop(n + row), here = conducting(n);
  const double flow_x = 0.5 * (here + conducting(n - row)) * g.per_hx * g.per_hx * x;
  const double flow_y = 0.5 * (here + conducting(n - 1)) * g.per_hy * g.per_hy * y;
  return {flow_x, flow_y, flow_x * x, flow_y * y};
}

double PoreWater::evening(const Particles& p, const GridState& g, std::size_t k, const Vec2& gravity) const {
  if (!flows(p, k)) return 0;
  const InElement in = element_of(p, g, k);
  const double *low = field_.potential + in.node, *high = low + field_.row;
  const double spanned =
      (1 - in.t) * ((1 - in.s) * low[0] + in.s * low[1]) + in.t * ((1 - in.s) * high[0] + in.s * high[1]);
  const double over = p.pressure[k] - head({p.x[k], p.y[k]}, gravity) - spanned;
  return rate_in_cell(g) * mobility_of(p, k) * p.volume0[k] * p.J[k] * over * over;
}

// What is not active any more is zero again.
void PoreWater::forget_nodes(const GridState& g) {
  if (nodes_ == g.active.nodes) return;
  for (const std::uint32_t n : nodes_) {
    sums_.node[n] = {};
    sums_.element[n] = {};
    for (double* values : {field_.volume, field_.potential, field_.even, field_.inert_x, field_.inert_y})
      if (values) values[n] = 0;
    for (float* values : {field_.weight, field_.flow_x, field_.flow_y, field_.strain_x, field_.strain_y}) values[n] = 0;
  }
  nodes_ = g.active.nodes;
}

void PoreWater::map_points(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads) {
  forget_nodes(g);
  mark_elements(p, g, tractions, time, threads);
  const PointView points = p.view();
  const PoreView pores = view(p, gravity);
  const CellView cells = g.view();
  const auto clear = [&](Range nodes, std::size_t) {
    for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
      sums_.node[g.active.nodes[a]] = {};
      sums_.element[g.active.nodes[a]] = {};
    }
  };
  const auto add = [&](Range range, std::size_t) { map_pores_lanes(g.centred, points, pores, cells, sums_, range); };
  for_bands(g.active.mapped, threads, clear, add, [](Range, std::size_t) {});
  tie_sums(g, gravity, time);
}

// Where loaded points and those without pores are.
void PoreWater::mark_elements(const Particles& p, GridState& g, const Tractions& tractions, double time, int threads) {
  const bool solids = std::any_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return !s.has_pores(); });
  if (marked_)
    for_nodes(g, threads, [&](Node&, std::uint32_t n) { marks_[n] = {}; });
  marked_ = solids || tractions.any();
  if (!marked_) return;
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    for_points_of(g, range, [&](std::uint32_t k) {
      const Traction* load = tractions.any() ? tractions.of(p.index[k]) : nullptr;
      if (load && time >= load->until) load = nullptr;
      if (!load && !solids) return;
      const std::size_t n = element_of(p, g, k).node;
      if (solids && !soil_of(p, k).has_pores()) marks_[n].solid = 1;
      if (!load) return;
      std::size_t boundary = load->boundary;  // of a point's loads one with a given flow, else the first
      for (; load && boundaries_.any_flux_on_tractions(); load = tractions.after(*load))
        if (time < load->until && boundaries_.comes_before(load->boundary, boundary) &&
            boundaries_.gives_flux(load->boundary))
          boundary = load->boundary;
      for (const std::size_t at : {n, n + 1, n + std::size_t(g.grid.nx), n + std::size_t(g.grid.nx) + 1})
        if (marks_[at].loaded == 0 || boundaries_.comes_before(boundary, marks_[at].loaded - 1u))
          marks_[at].loaded = std::uint16_t(boundary + 1) & most_marked;
    });
  });
}

// Where potentials or flow may be given: at the material's surface (`parts`: nodes in their order), at walls, and
// beside what has no pores.
std::vector<std::uint32_t> PoreWater::special_nodes(const GridState& g,
                                                    const std::vector<std::vector<std::uint32_t>>& parts) const {
  std::vector<std::uint32_t> others;
  for (int field = 0; field < g.velocity_fields; ++field)
    for (const std::uint32_t n : boundaries_.let_through())
      others.push_back(std::uint32_t(n + std::size_t(field) * g.field_nodes()));
  const auto row = std::uint32_t(field_.row);
  if (marked_)
    for (const std::uint32_t n : g.active.nodes)
      if (marks_[n].solid) others.insert(others.end(), {n, n + 1, n + row, n + row + 1});
  std::sort(others.begin(), others.end());
  others.erase(std::unique(others.begin(), others.end()), others.end());
  std::vector<std::uint32_t> surface, all;
  for (const auto& part : parts) surface.insert(surface.end(), part.begin(), part.end());
  std::set_union(surface.begin(), surface.end(), others.begin(), others.end(), std::back_inserter(all));
  return all;
}

void PoreWater::take_means(const GridState& g, const Vec2& gravity, double time, double dt, int threads) {
  PoreFields f = field_;
  if (!alike_.own) f.rate = nullptr;
  const double yields = projected() ? dt * dt / inertia_ : 0;
  const PoreEdges edges{projected() ? 0 : rate_in_cell(g) * dt, dt * g.per_hx * g.per_hx, dt * g.per_hy * g.per_hy, alike_.mobility,
                        least_share * g.grid.spacing.prod(), yields * g.per_hx * g.per_hx,
                        yields * g.per_hy * g.per_hy};
  std::vector<std::vector<std::uint32_t>> parts(node_parts(g));
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::uint32_t special[nodes_in_part];
    const std::size_t found = take_means_lanes(sums_, f, edges, g.active.nodes.data() + begin, end - begin, special);
    parts[part].assign(special, special + found);
  });
  const std::vector<std::uint32_t> special = special_nodes(g, parts);
  given_.clear();
  free_.clear();
  surface_.clear();
  through_.clear();
  for (const std::uint32_t n : special) {
    const double mean = field_.potential[n];
    if (!(sums_.node[n].volume > 0)) continue;
    if (boundaries_.passes(n, time)) field_.even[n] = 0;  // no strain is smoothed beside it
    const Surface surface = give_potential(g, n, gravity, time);
    if (surface == Surface::free) free_.push_back(n);
    if (surface != Surface::none && !boundaries_.at(n, time)) surface_.push_back(n);
    if (loaded_with_flow(n) && surface == Surface::free) field_.even[n] = 0;
    if (surface == Surface::given) given_.push_back({n, alike_.own ? field_.rate[n] : alike_.mobility, mean});
    else if (const double flux = flux_into(g, n, time, [this](std::ptrdiff_t element) { return sums_.element[element].inside > 0; }); flux != 0) through_.push_back({n, dt * flux});
  }
  tie_given(g, gravity);
  mark_given(true);
  conduct_along_borders(g, dt);
  conduct_to_surface(g, dt);
}

// An element that the surface cuts holds less than it conducts: what is given is not a cell away, but as far as the element is full.
void PoreWater::conduct_to_surface(const GridState& g, double dt) {
  for (const std::uint32_t n : surface_) {
    if (!marks_[n].given) continue;
    // (`of_first`, `of_beside`: twice the edge's share of what flows in the elements.)
    const auto edge = [&](std::ptrdiff_t first, std::ptrdiff_t other, std::ptrdiff_t beside, double of_first, double of_beside, double per_h,
                          float* flow, double* inert) {
      if ((marks_ + other)->given || !(field_.volume[other] > 0)) return;
      const double in_first = sums_.element[first].inside, in_beside = sums_.element[beside].inside, held = of_first * in_first + of_beside * in_beside;
      const double full = (in_first > 0 ? of_first * full_element(g, first) : 0) + (in_beside > 0 ? of_beside * full_element(g, beside) : 0);
      if (!(held > 0) || held >= full) return;
      const double mobility = alike_.own ? field_.rate[other] : alike_.mobility;
      const double more = 0.5 * dt * mobility * per_h * per_h * (std::min(least_distance_inverse * full, full * full / held) - held);
      flow[first] += float(more);
      if (inert) inert[first] += more;
    };
    const std::ptrdiff_t at = n, row = field_.row;
    const double right = 2 * share_of_right(at), left = 2 * share_of_left(at);
    edge(at, at + 1, at - row, 1, 1, g.per_hx, field_.flow_x, field_.inert_x);
    edge(at - 1, at - 1, at - 1 - row, 1, 1, g.per_hx, field_.flow_x, field_.inert_x);
    edge(at, at + row, at - 1, right, left, g.per_hy, field_.flow_y, field_.inert_y);
    edge(at - row, at - row, at - row - 1, right, left, g.per_hy, field_.flow_y, field_.inert_y);
  }
}

PoreWater::Surface PoreWater::give_potential(const GridState& g, std::size_t n, const Vec2& gravity, double time) {
  const PoreCondition* condition = boundaries_.at(n, time);
  bool by_load = false;
  if (!condition) {
    const auto holds = [this](std::size_t element) { return sums_.element[element].inside > 0 || marks_[element].solid; };
    if (!at_surface(g, n, sums_.node[n].volume, time, holds)) {
      const PoreMark *here = marks_ + n, *below = here - field_.row;
      return here->solid || here[-1].solid || below->solid || below[-1].solid ? Surface::free : Surface::none;
    }
    by_load = marks_[n].loaded > 0;
    if (by_load) condition = &boundaries_.of_boundary(std::size_t(marks_[n].loaded - 1));
  }
  const Vec2 x = g.position(n);
  if (condition) {
    if (!condition->gives_pressure()) return by_load ? Surface::free : Surface::none;
    field_.potential[n] = given_pressure(*condition, x, gravity) - head(x, gravity);
  } else if (imposed()) {
    field_.potential[n] = outside_pressure(x, gravity) - head(x, gravity);
  } else {
    // With a level, the water's surface is at it, and not at the node that is next above.
    const double above = level_ ? std::max(0.0, x.y() - g.grid.spacing.y() - *level_) + *level_ - reference_.y() : 0;
    field_.potential[n] = level_ ? options_.density_kg_m3 * -gravity.y() * above : -head(x, gravity);
  }
  return Surface::given;
}

void PoreWater::mark_given(bool given) {
  for (const Given& at : given_) marks_[at.node].given = given ? 1 : 0;
}

// There the potential is not the mean, to which the node's points are brought, and what flows comes from outside; and the flow that
// is given where potentials are not.
PoreFlow PoreWater::at_given_nodes(double rate) {
  PoreFlow sum;
  const PoreFields& f = field_;
  const auto count = [&](double volume, double potential) { sum.add({volume, volume * potential, volume * potential}); };
  for (const Given& at : given_) {
    const std::uint32_t n = at.node;
    const double potential = f.potential[n];
    const auto to = [&](std::ptrdiff_t other, double exchange) {
      return (marks_ + n)[other].given ? 0 : exchange * (potential - (f.potential + n)[other]);
    };
    const double passed = to(1, f.flow_x[n]) + to(-1, (f.flow_x + n)[-1]) + to(f.row, f.flow_y[n]) + to(-f.row, (f.flow_y + n)[-f.row]);
    count(passed + rate * at.mobility * at.share * f.volume[n] * (potential - at.mean), potential);
    f.change[n] = rate * (alike_.own ? 1 : at.mobility) * potential;
  }
  for (const Through& through : through_) {
    f.change[through.node] += through.volume / capacity(through.node);
    count(through.volume, f.potential[through.node]);
  }
  return sum;
}

// Calls each(point, piece of load, m^2 of water) where flow is given through the loaded faces of points.
template <class Each>
void PoreWater::for_flow_through_tractions(const Particles& p, const Tractions& tractions, double time, double dt,
                                           Each&& each) const {
  if (!boundaries_.any_flux_on_tractions()) return;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended || !flows(p, k)) continue;
    for (const Traction* load = tractions.of(p.index[k]); load; load = tractions.after(*load)) {
      const PoreCondition& condition = boundaries_.of_boundary(load->boundary);
      if (time >= load->until || condition.kind != PoreCondition::flux) continue;
      const double face = load->face * (about_axis() ? p.x[k] / p.F_zz[k] + load->out.x() : 1);
      each(k, *load, dt * condition.value * face);
    }
  }
}

// To the nodes along the faces, as beside a wall; through those whose potential is given it leaves again. (At the
// points themselves, pressure would rise against the water's own stiffness wherever nodes do not see it.)
void PoreWater::take_flow_through_tractions(const Particles& p, const GridState& g, const Tractions& tractions,
                                            double time, double dt) {
  for_flow_through_tractions(p, tractions, time, dt, [&](std::size_t k, const Traction& load, double volume) {
    const InElement in = element_of(p, g, k);
    const double s = std::clamp(in.s + load.out.x() * g.per_hx, 0.0, 1.0),
                 t = std::clamp(in.t + load.out.y() * g.per_hy, 0.0, 1.0);
    const std::size_t row = std::size_t(g.grid.nx), at[] = {in.node, in.node + 1, in.node + row, in.node + row + 1};
    double weight[] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t}, all = 0;
    for (int c = 0; c < 4; ++c) all += weight[c] = field_.volume[at[c]] > 0 ? weight[c] : 0;
    for (int c = 0; c < 4; ++c)
      if (weight[c] > 0 && !marks_[at[c]].given) through_.push_back({std::uint32_t(at[c]), volume * weight[c] / all});
  });
}

// Where pores are not all full: to the points themselves.
PoreFlow PoreWater::fill_through_tractions(Particles& p, const Tractions& tractions, const Vec2& gravity, double time,
                                           double dt) const {
  PoreFlow sum;
  for_flow_through_tractions(p, tractions, time, dt, [&](std::size_t k, const Traction&, double volume) {
    const auto potential = [&] {
      const double filled = p.content[k] / std::max(least_pores, p.J_flow[k] - (1 - soil_of(p, k).porosity));
      return potential_in_pores(p, k, filled, gravity);
    };
    const double before = potential();
    p.content[k] += volume / p.volume0[k];
    sum.inflow += volume;
    sum.external += volume * 0.5 * (before + potential());
  });
  return sum;
}

}  // namespace pivnp::mpm

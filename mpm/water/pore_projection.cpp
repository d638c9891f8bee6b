// The flow of a step with pressure implicit (docs/theory/mpm_water.md#projected).
#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/pore_elements.hpp"
#include "mpm/water/pore_projection_lanes.hpp"
#include "mpm/water/pore_water.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr double small_residual = 1e-4;   // of the residual, over that of the guess zero
constexpr int iterations_at_most = 2000;
constexpr double at_free_surface = 16;  // over h^2: what lets an impervious surface yield to the pressure
constexpr double per_light = 3;         // of what the light nodes of a surface foresee beside it
constexpr double per_lack = 8;          // over h^2: of what an element lacks that the surface cuts

template <class Part>
double sum_parts(const GridState& g, int threads, Part&& of_part) {
  std::vector<double> parts(node_parts(g));
  for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
    parts[part] = of_part(g.active.nodes.data() + begin, end - begin);
  });
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

// What nodes n exchange by `x` and `y` of the edges for differences of `of`.
double exchanged(const float* x, const float* y, const double* of, std::ptrdiff_t row) {
  return x[0] * (of[1] - of[0]) + x[-1] * (of[-1] - of[0]) + y[0] * (of[row] - of[0]) + y[-row] * (of[-row] - of[0]);
}

// From the guess in s.solution; true if it has become small enough.
bool solve(const PoreSystem& s, const GridState& g, double enough, double left, int threads) {
  double before = left;
  for (int n = 0; n < iterations_at_most && left > enough; ++n) {
    for_node_parts(g, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
      turn_lanes(s, n == 0 ? 0 : left / before, g.active.nodes.data() + begin, end - begin);
    });
    const double curvature = sum_parts(g, threads, [&](const std::uint32_t* nodes, std::size_t size) { return product_lanes(s, nodes, size); });
    if (!(curvature > 0)) return false;
    const double step = left / curvature;
    before = left;
    left = sum_parts(g, threads, [&](const std::uint32_t* nodes, std::size_t size) { return advance_lanes(s, step, nodes, size); });
  }
  return left <= enough;
}

}  // namespace

void PoreWater::project(const GridState& g, double foreseen_share) {
  const std::size_t before = std::size_t(g.grid.nx) + 8;
  for (int k = 0; k < 9; ++k) system_.emplace_back(g.grid.node_count() + 2 * before);
  const auto field = [&](int k) { return system_[std::size_t(k)].data() + before; };
  field_.inert_x = field(0);
  field_.inert_y = field(1);
  inertia_ = std::numeric_limits<double>::max();
  for (const PoreSoil& soil : soils_)
    if (soil.holds_water()) inertia_ = std::min(inertia_, (soil.dry_density() + options_.density_kg_m3 * soil.porosity) / foreseen_share);
}

// The strain of an element beside the surface follows a pressure on its other nodes the more, the lighter the surface's nodes are
// and the less the element holds: what the edges to the surface do not foresee of it.
void PoreWater::yield_beside_surface(const GridState& g, double inertia, double* added) const {
  std::vector<std::ptrdiff_t> beside;
  const auto around = [&](std::ptrdiff_t n) { return std::array{n, n - 1, n - field_.row, n - field_.row - 1}; };
  const auto at_surface = [&](std::ptrdiff_t n) { return std::binary_search(surface_.begin(), surface_.end(), std::uint32_t(n)); };
  for (const std::uint32_t n : surface_)
    for (const std::ptrdiff_t e : around(n))
      if (sums_.element[e].inside > 0) beside.push_back(e);
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  const double per_area = inertia * std::max(g.per_hx * g.per_hx, g.per_hy * g.per_hy);
  for (const std::ptrdiff_t e : beside) {
    const double cell = full_element(g, e);
    double of_surface = 0;  // of the element's volume
    int others = 0;
    for (const std::ptrdiff_t n : {e, e + 1, e + field_.row, e + field_.row + 1}) {
      if (!at_surface(n)) {
        ++others;
        continue;
      }
      // (Of an element, what it would have of a node's volume beside three others.)
      const auto part = [&](std::ptrdiff_t k) { return (k == n || k == n - field_.row ? 2 * share_of_right(n) : 2 * share_of_left(n)) * ring(g, k); };
      double all = 0;
      for (const std::ptrdiff_t k : around(n))
        if (sums_.element[k].inside > 0) all += part(k);
      of_surface += field_.volume[n] * part(e) / all;
    }
    if (others == 0) continue;
    const double rest = std::max(0.0, sums_.element[e].inside - of_surface);
    const double light = std::max(0.0, per_light * rest * rest / std::max(of_surface, 1e-4 * cell) - 0.5 * cell) / others;
    const double lacks = per_lack * std::max(0.0, 1 - sums_.element[e].inside / cell);
    for (const std::ptrdiff_t n : {e, e + 1, e + field_.row, e + field_.row + 1})
      if (!at_surface(n)) added[n] += per_area * (light + lacks * field_.volume[n]);
  }
}

PoreFlow PoreWater::flow_projected(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                                   std::vector<double>& guess, int threads) {
  set_outside(p, gravity);
  PoreFlow sums;
  mix_at_borders(p, g, threads);
  map_points(p, g, tractions, gravity, time, threads);
  take_pores(p, g, threads);
  take_means(g, gravity, time, dt, threads);
  take_flow_through_tractions(p, g, tractions, time, dt);
  const PoreFields& f = field_;
  const std::size_t before = std::size_t(g.grid.nx) + 8;
  const auto field = [&](int k) { return system_[std::size_t(k)].data() + before; };
  guess.resize(g.grid.node_count());
  const PoreSystem s{f.inert_x, f.inert_y, field(2), field(3), field(4), field(5), field(6), field(7), f.row};
  double* added = s.product;  // until it is one
  double* driving = field(8);
  const auto for_all = [&](auto&& each) {
    for_node_parts(g, threads, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t a = begin; a < end; ++a) each(g.active.nodes[a]);
    });
  };
  for_all([&](std::size_t n) {
    added[n] = s.direction[n] = f.change[n] = 0;
    s.solution[n] = f.volume[n] > 0 && !marks_[n].given ? guess[n] : 0;
  });
  const double inertia = dt * dt / inertia_;
  for (const std::uint32_t n : free_) added[n] = at_free_surface * inertia * f.volume[n] * std::max(g.per_hx * g.per_hx, g.per_hy * g.per_hy);
  yield_beside_surface(g, inertia, added);
  for (const Through& through : through_) f.change[through.node] += through.volume;
  // (1 + share (1 - M)) of nodes' values; with half of it the flow is of fourth order.
  const auto beyond = [&](const double* of, std::size_t n, double share = 1) {
    if (marks_[n].given || !(capacity(n) > 0)) return of[n];
    return of[n] - share / capacity(n) * exchanged(f.strain_x + n, f.strain_y + n, of + n, f.row);
  };
  for_all([&](std::size_t n) { driving[n] = beyond(f.potential, n, 0.5); });
  double of_zero = 0;
  const double left = [&] {
    std::vector<std::array<double, 2>> parts(node_parts(g));
    for_node_parts(g, threads, [&](std::size_t part, std::size_t begin, std::size_t end) {
      std::array<double, 2> sum{};
      for (std::size_t a = begin; a < end; ++a) {
        const std::size_t n = g.active.nodes[a];
        const double edges = (f.inert_x[n] + (f.inert_x + n)[-1]) + (f.inert_y[n] + (f.inert_y + n)[-f.row]);
        const double diagonal = pores_at(n) / options_.bulk_modulus_pa + edges + added[n];
        const bool open = f.volume[n] > 0 && !marks_[n].given && diagonal > 0;
        s.diagonal[n] = diagonal;
        s.inverse[n] = open ? 1 / diagonal : 0;
        const double load = exchanged(f.flow_x + n, f.flow_y + n, driving + n, f.row) + f.change[n] - sums_.node[n].strained;
        const double* x = s.solution + n;
        const double product = diagonal * x[0] - (s.along_x[n] * x[1] + (s.along_x + n)[-1] * x[-1] + s.along_y[n] * x[f.row] + (s.along_y + n)[-f.row] * x[-f.row]);
        s.residual[n] = load - product;
        sum[0] += load * load * s.inverse[n];
        sum[1] += s.residual[n] * s.residual[n] * s.inverse[n];
      }
      parts[part] = sum;
    });
    double sum = 0;
    for (const auto& part : parts) {
      of_zero += part[0];
      sum += part[1];
    }
    return sum;
  }();
  if (!solve(s, g, small_residual * small_residual * of_zero, left, threads))
    throw RunError("the projected pressure was not found in " + std::to_string(iterations_at_most) + " iterations");
  // The potential after the step; then what the points take.
  for_all([&](std::size_t n) {
    guess[n] = s.solution[n];
    s.residual[n] = driving[n] + s.solution[n];
  });
  // Of all points alike, as slow as the least pervious soil: where it differs from node to node, means change at first order in h.
  double slowest = std::numeric_limits<double>::max();
  for (const PoreSoil& soil : soils_)
    if (soil.holds_water())
      slowest = std::min(slowest, soil.mobility / (soil.porosity / options_.bulk_modulus_pa + 1 / soil.constrained_modulus));
  const double by_cell = rate_in_cell(g) * dt * slowest, share = by_cell / (1 + by_cell);
  for_all([&](std::size_t n) {
    const double volume = f.volume[n];
    f.change[n] = f.even[n] = s.direction[n] = 0;
    if (!(volume > 0)) return;
    s.direction[n] = share;
    if (marks_[n].given) {
      f.even[n] = share * f.potential[n];
      return;
    }
    f.even[n] = beyond(s.solution, n) + share * beyond(f.potential, n);
    f.change[n] = capacity(n) > 0 ? exchanged(f.flow_x + n, f.flow_y + n, s.residual + n, f.row) / capacity(n) : 0;
  });
  for (const Through& through : through_) {
    f.change[through.node] += through.volume / capacity(through.node);
    sums.add({through.volume, through.volume * s.residual[through.node], through.volume * s.residual[through.node]});
  }
  for (const Given& at : given_) {
    const std::uint32_t n = at.node;
    // Its points' pressures change by the mean of what they are brought to, and take the water that fits.
    const double brought = f.even[n] + exchanged(f.strain_x + n, f.strain_y + n, f.even + n, f.row) / capacity(n);
    const double fits = pores_at(n) / options_.bulk_modulus_pa * (brought - s.direction[n] * at.mean) + sums_.node[n].strained;
    f.change[n] = fits / capacity(n);
    double from_others = 0;
    const auto from = [&](std::ptrdiff_t other, double exchange) {
      if (!(marks_ + n)[other].given) from_others += exchange * ((s.residual + n)[other] - s.residual[n]);
    };
    from(1, f.flow_x[n]);
    from(-1, (f.flow_x + n)[-1]);
    from(f.row, f.flow_y[n]);
    from(-f.row, (f.flow_y + n)[-f.row]);
    const double through = fits - from_others;
    sums.add({through, through * f.potential[n], through * f.potential[n]});
  }
  const PointView points = p.view();
  const PoreView pores = view(p, gravity);
  const CellView cells = g.view();
  std::vector<PoreLosses> parts(g.active.flowing.size());
  for_flowing(g, threads, [&](Range range, std::size_t piece) {
    parts[piece] = project_points_lanes(g.centred, points, pores, cells, f, s.direction, range);
  });
  sums.yielded = sums.external;
  for (const PoreLosses& part : parts) {
    sums.darcy += part.by_flow;
    sums.yielded += part.all;
  }
  sums.yielded -= sums.darcy;
  mark_given(false);
  follow_porosity(p, threads);
  return sums;
}

}  // namespace pivnp::mpm

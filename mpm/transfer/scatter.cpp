#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

void locate_anew(Particles& p, const GridState& g, std::size_t k) {
  const auto velocity_field = int(std::size_t(p.cell[k]) / g.field_nodes());
  double xi = 0, eta = 0;
  if (!g.find(p.x[k], p.y[k], p.cell[k], xi, eta, velocity_field)) p.cell[k] = Particles::ended;
}

// Axisymmetric: the force of the hoop stress.
void map_hoop_force(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  if (!scheme.axisymmetric) return;
  const PointView points = p.view();
  const CellView cells = g.view();
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) { map_hoop_lanes(g.shape, scheme.locking, points, cells, range); });
}

}  // namespace

void locate_all(Particles& p, GridState& g) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) locate_anew(p, g, k);
  g.rebuild(p);
}

bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads) {
  g.cells.arrivals.clear();
  if (!g.relocation.done) {
    const PointView points = p.view();
    const CellView cells = g.view();
    // Each piece writes from its first point's place on.
    g.relocation.suspects.resize(g.cells.order.size());
    g.relocation.found.resize(g.active.pieces.size());
    for_pieces(g, threads, [&](Range range, std::size_t piece) {
      const std::size_t first = g.cells.begin[range.begin];
      g.relocation.found[piece] = {first, first + locate_lanes(points, cells, range, g.relocation.suspects.data() + first)};
    });
  }
  g.relocation.done = false;
  g.relocation.moves.clear();
  for (const Range& range : g.relocation.found)
    for (std::size_t a = range.begin; a < range.end; ++a) {
      const std::uint32_t q = g.relocation.suspects[a], k = g.cells.order[q];
      const std::int32_t before = p.cell[k];
      locate_anew(p, g, k);
      if (p.cell[k] == before) continue;
      g.relocation.moves.push_back({q, before});
      if (p.cell[k] == Particles::ended) left.push_back(k);
    }
  return !g.relocation.moves.empty();
}

void map_sums(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads,
              const std::function<void(Range nodes, std::size_t band)>& finished) {
  const auto clear = [&](Range nodes, std::size_t) {
    for_nodes_ahead(
        g, nodes, [&](std::uint32_t n) { __builtin_prefetch(&g.node[n], 1); },
        [&](std::uint32_t n) {
          Node& node = g.node[n];  // n is set by the update
          node.mass = node.vx = node.vy = node.fx = node.fy = 0;
          node.held_x = node.held_y = false;
          if (g.by_updated) return;
          const GridState::StrainVelocity u = g.strain_velocity(n);
          u.x = u.y = 0;
        });
  };
  const PointView points = p.view();
  const CellView cells = g.view();
  const bool affine = scheme.affine();
  const auto map = [&](Range range, std::size_t) {
    map_lanes(g.shape, affine, true, force, scheme.locking, points, cells, range);
  };
  for_bands(g.active.mapped, threads, clear, map, finished);
}

void map_momentum(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads) {
  const double rounding = mass_of_rounding(p);
  map_sums(p, g, scheme, force, threads, [&](Range nodes, std::size_t) {
    for_nodes_in(g, nodes, [&](Node& node) {
      if (node.mass < rounding) forget_sums(node);
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      node.vx *= per_mass;
      node.vy *= per_mass;
    });
  });
  if (force) map_hoop_force(p, g, scheme, threads);
}

void map_force(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.fx = node.fy = 0; });
  const PointView points = p.view();
  const CellView cells = g.view();
  for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
    map_lanes(g.shape, false, false, true, scheme.locking, points, cells, range);
  });
  map_hoop_force(p, g, scheme, threads);
}

void average_mean_stress(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  if (!averages_at_corners(g, scheme)) return;
  const PointView points = p.view();
  const CellView cells = g.view();
  average_at_corners(g, Averaging::of_stress, true, threads, [&](Range range, std::size_t) { average_stress_lanes(points, cells, range); });
}

void map_acceleration(const Particles& p, GridState& g, const std::vector<double>& ax, const std::vector<double>& ay,
                      int threads) {
  OfGrid<NodeVelocity>& out = g.arrays.loads;
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      for_points<S>(p, g, range, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
        for (int c = 0; c < W * W; ++c) {
          const double m = p.mass_of(k) * x.w[c % W] * y.w[c / W];
          out[at[c]].x += m * ax[k];
          out[at[c]].y += m * ay[k];
        }
      });
    });
  });
}

std::vector<double> stiffness_bound(const Particles& p, const GridState& g, const std::vector<double>& modulus) {
  std::vector<double> mass(g.grid.node_count(), 0.0);
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for_points<S>(p, g, {0, g.cells.size()}, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
      double size[W * W], total = 0;
      for (int c = 0; c < W * W; ++c) {
        double gx = std::abs(x.g[c % W] * y.w[c / W]) * g.per_hx, gy = std::abs(x.w[c % W] * y.g[c / W]) * g.per_hy;
        if (!g.centred) {  // the element's centre may take the place of the point
          gx = std::max(gx, 0.5 * g.per_hx);
          gy = std::max(gy, 0.5 * g.per_hy);
        }
        const double hoop = g.axisymmetric ? x.w[c % W] * y.w[c / W] / p.x[k] : 0;
        size[c] = std::sqrt(gx * gx + gy * gy + hoop * hoop);
        total += size[c];
      }
      // omega^2 <= row / mass must stay below 4 for the pseudo-step 1; the factor leaves a margin of two.
      for (int c = 0; c < W * W; ++c) mass[at[c]] += 0.5 * p.volume0[k] * modulus[k] * size[c] * total;
    });
  });
  return mass;
}

}  // namespace pivnp::mpm

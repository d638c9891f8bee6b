#include <algorithm>
#include <cmath>

#include "mpm/grid/kernel.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

void locate_anew(Particles& p, const GridState& g, std::size_t k) {
  const auto on_sheet = int(std::size_t(p.cell[k]) / g.sheet_nodes());
  double xi = 0, eta = 0;
  if (!g.find(p.x[k], p.y[k], p.cell[k], xi, eta, on_sheet)) p.cell[k] = Particles::ended;
}

}  // namespace

void locate_all(Particles& p, GridState& g) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) locate_anew(p, g, k);
  g.rebuild(p);
}

bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads) {
  g.arrivals.clear();
  if (!g.located) {
    const PointView points = p.view();
    const CellView cells = g.view();
    // Each piece writes from its first point's place on.
    g.scratch.resize(g.order.size());
    g.suspects.resize(g.pieces.size());
    for_pieces(g, threads, [&](SlotRange slots, std::size_t piece) {
      const std::size_t first = g.slot_begin[slots.begin];
      g.suspects[piece] = {first, first + locate_lanes(points, cells, slots, g.scratch.data() + first)};
    });
  }
  g.located = false;
  g.moved.clear();
  for (const SlotRange& range : g.suspects)
    for (std::size_t a = range.begin; a < range.end; ++a) {
      const std::uint32_t q = g.scratch[a], k = g.order[q];
      const std::int32_t before = p.cell[k];
      locate_anew(p, g, k);
      if (p.cell[k] == before) continue;
      g.moved.push_back({q, before});
      if (p.cell[k] == Particles::ended) left.push_back(k);
    }
  return !g.moved.empty();
}

void map_sums(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads,
              const std::function<void(SlotRange nodes, std::size_t band)>& finished) {
  const auto clear = [&](SlotRange nodes, std::size_t) {
    for (std::size_t a = nodes.begin; a < nodes.end; ++a) {
      const std::uint32_t n = g.nodes[a];
      Node& node = g.node[n];  // n is set by the update
      node.mass = node.vx = node.vy = node.fx = node.fy = 0;
      node.held = false;
      if (g.by_updated) continue;
      const GridState::Straining u = g.straining(n);
      u.x = u.y = 0;
    }
  };
  const PointView points = p.view();
  const CellView cells = g.view();
  const bool affine = scheme.transfer == TransferKind::apic;
  const auto map = [&](SlotRange slots, std::size_t) {
    map_lanes(g.shape, affine, true, force, scheme.locking, points, cells, slots);
  };
  for_bands(g.mapped, threads, clear, map, finished);
}

void map_momentum(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads) {
  map_sums(p, g, scheme, force, threads, [&](SlotRange nodes, std::size_t) {
    for_nodes_in(g, nodes, [](Node& node) {
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      node.vx *= per_mass;
      node.vy *= per_mass;
    });
  });
}

void map_force(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  for_nodes(g, threads, [&](Node& node, std::uint32_t) { node.fx = node.fy = 0; });
  const PointView points = p.view();
  const CellView cells = g.view();
  for_bands(g.mapped, threads, [&](SlotRange slots, std::size_t) {
    map_lanes(g.shape, false, false, true, scheme.locking, points, cells, slots);
  });
}

void average_mean_stress(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  if (g.width == 2 || scheme.locking != Locking::fbar) return;
  const PointView points = p.view();
  const CellView cells = g.view();
  average_at_corners(g, Averaging::of_stress, true, threads, [&](SlotRange slots, std::size_t) { average_stress_lanes(points, cells, slots); });
}

void map_acceleration(const Particles& p, GridState& g, const std::vector<double>& ax, const std::vector<double>& ay,
                      std::vector<double>& out, int threads) {
  out.assign(2 * g.grid.node_count(), 0.0);
  with_shape(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for_bands(g.mapped, threads, [&](SlotRange slots, std::size_t) {
      for (std::size_t s = slots.begin; s < slots.end; ++s) {
        std::size_t at[9];
        g.stencil_nodes(s, at);
        const SlotLines<S> lines(g, s);
        for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
          const std::size_t k = g.order[q];
          const auto lx = lines.x(p, k), ly = lines.y(p, k);
          for (int c = 0; c < W * W; ++c) {
            const double m = p.mass_of(k) * lx.w[c % W] * ly.w[c / W];
            out[2 * at[c]] += m * ax[k];
            out[2 * at[c] + 1] += m * ay[k];
          }
        }
      }
    });
  });
  for_nodes(g, threads, [&](Node& node, std::uint32_t n) {
    node.fx += out[2 * n];
    node.fy += out[2 * n + 1];
  });
}

std::vector<double> stiffness_bound(const Particles& p, const GridState& g, const std::vector<double>& modulus) {
  std::vector<double> mass(g.grid.node_count(), 0.0);
  with_shape(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for (std::size_t s = 0; s < g.slots(); ++s) {
      std::size_t at[9];
      g.stencil_nodes(s, at);
      const SlotLines<S> lines(g, s);
      for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
        const std::size_t k = g.order[q];
        const auto lx = lines.x(p, k), ly = lines.y(p, k);
        double size[9], total = 0;
        for (int b = 0; b < W; ++b)
          for (int a = 0; a < W; ++a) {
            double gx = std::abs(lx.g[a] * ly.w[b]) * g.per_hx, gy = std::abs(lx.w[a] * ly.g[b]) * g.per_hy;
            if (W == 2) {  // the centre's gradient may take the place of the point's own
              gx = std::max(gx, 0.5 * g.per_hx);
              gy = std::max(gy, 0.5 * g.per_hy);
            }
            size[b * W + a] = std::sqrt(gx * gx + gy * gy);
            total += size[b * W + a];
          }
        // omega^2 <= row / mass must stay below 4 for the pseudo-step 1; the factor leaves a margin of two.
        for (int c = 0; c < W * W; ++c) mass[at[c]] += 0.5 * p.volume0[k] * modulus[k] * size[c] * total;
      }
    }
  });
  return mass;
}

}  // namespace pivnp::mpm

#include "mpm/step/own_frequency.hpp"

#include <algorithm>
#include <vector>

#include "mpm/grid/sweeps.hpp"

namespace pivnp::mpm {

double own_frequency2(const Particles& p, const GridState& g, int threads) {
  std::vector<double> greatest(g.active.pieces.size(), 0.0);
  const double h = g.grid.spacing.minCoeff(), along_x = h * g.per_hx, along_y = h * g.per_hy;
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for_pieces(g, threads, [&](Range cells, std::size_t piece) {
      double most = 0;
      for_points<S>(p, g, cells, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
        double sum = 0;
        for (int b = 0; b < W; ++b)
          for (int a = 0; a < W; ++a) {
            const double gx = along_x * x.g[a] * y.w[b], gy = along_y * x.w[a] * y.g[b], mass = g.node[at[b * W + a]].mass;
            if (mass > 0) sum += (gx * gx + gy * gy) / mass;
          }
        most = std::max(most, sum * p.mass_of(k));
      });
      greatest[piece] = most;
    });
  });
  return greatest.empty() ? 0 : *std::max_element(greatest.begin(), greatest.end());
}

double own_frequency2_at_start(const Particles& p, GridState& g) {
  for_nodes(g, 1, [](Node& node, std::uint32_t) { node.mass = 0; });
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width;
    for_points<S>(p, g, {0, g.cells.size()}, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
      for (int n = 0; n < W * W; ++n) g.node[at[n]].mass += p.mass_of(k) * x.w[n % W] * y.w[n / W];
    });
  });
  return own_frequency2(p, g, 1);
}

double held_frequency2(double before, double now) { return std::max(now, 0.995 * before); }

}  // namespace pivnp::mpm

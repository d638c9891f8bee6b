#include "pivnp/piv/validation/closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/core/math.hpp"

namespace pivnp::piv {

namespace {

constexpr int mean_reach = 2;     // nodes to either side that are averaged over
constexpr double most = 10;  // limit of a single place's strength, so that a few extreme places decide nothing
constexpr double least_strength = 1, sure = 4;

// Products of a node's differences, averaged over the pairs of chains that know it.
struct Products {
  double xx = 0, yy = 0, xy = 0;
  double var_x = 0, var_y = 0;  // of xx, yy if errors are as stated
};

bool products_at(std::size_t n, std::span<const ClosureChain> chains, Products& out) {
  int pairs = 0;
  out = {};
  for (std::size_t u = 0; u < chains.size(); ++u)
    for (std::size_t v = u + 1; v < chains.size(); ++v) {
      const auto &a = chains[u].off[n], &b = chains[v].off[n];
      const auto &va = chains[u].variance[n], &vb = chains[v].variance[n];
      if (!std::isfinite(a[0] + a[1] + b[0] + b[1] + va[0] + va[1] + vb[0] + vb[1])) continue;
      const double scale = 1.0 / ((chains[u].steps - 1) * (chains[v].steps - 1));
      out.xx += scale * a[0] * b[0];
      out.yy += scale * a[1] * b[1];
      out.xy += 0.5 * scale * (a[0] * b[1] + a[1] * b[0]);
      out.var_x += scale * scale * va[0] * vb[0];
      out.var_y += scale * scale * va[1] * vb[1];
      ++pairs;
    }
  if (pairs == 0) return false;
  for (double* value : {&out.xx, &out.yy, &out.xy}) *value /= pairs;
  for (double* value : {&out.var_x, &out.var_y}) *value /= double(pairs) * pairs;
  return true;
}

// Mean over the known nodes around (i, j).
bool mean_around(const Grid& grid, const std::vector<Products>& at, const std::vector<std::uint8_t>& known, int i,
                 int j, Products& out) {
  int count = 0;
  out = {};
  for (int b = std::max(0, j - mean_reach); b <= std::min(grid.ny - 1, j + mean_reach); ++b)
    for (int a = std::max(0, i - mean_reach); a <= std::min(grid.nx - 1, i + mean_reach); ++a) {
      const std::size_t n = grid.node(a, b);
      if (!known[n]) continue;
      out.xx += at[n].xx, out.yy += at[n].yy, out.xy += at[n].xy;
      out.var_x += at[n].var_x, out.var_y += at[n].var_y;
      ++count;
    }
  if (count == 0) return false;
  for (double* value : {&out.xx, &out.yy, &out.xy, &out.var_x, &out.var_y}) *value /= count;
  return true;
}

double strength_of(double value, double variance) {
  return variance > 0 ? std::clamp(value / std::sqrt(variance), -most, most) : 0;
}

// Nodes with NaN take the mean of neighbours that have a value, ring by ring.
void fill_inward(const Grid& grid, std::vector<std::array<float, 3>>& cov) {
  for (bool filled = true; filled;) {
    filled = false;
    const std::vector<std::array<float, 3>> before = cov;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        if (!std::isnan(before[grid.node(i, j)][0])) continue;
        std::array<float, 3> sum{};
        int count = 0;
        for (int b = std::max(0, j - 1); b <= std::min(grid.ny - 1, j + 1); ++b)
          for (int a = std::max(0, i - 1); a <= std::min(grid.nx - 1, i + 1); ++a) {
            const auto& near = before[grid.node(a, b)];
            if (std::isnan(near[0])) continue;
            for (std::size_t k = 0; k < 3; ++k) sum[k] += near[k];
            ++count;
          }
        if (count == 0) continue;
        for (std::size_t k = 0; k < 3; ++k) cov[grid.node(i, j)][k] = sum[k] / static_cast<float>(count);
        filled = true;
      }
  }
}

}  // namespace

RepeatedError repeated_error(const Grid& grid, double correlation_length, std::span<const ClosureChain> chains) {
  RepeatedError out;
  std::vector<Products> own(grid.node_count());
  std::vector<std::uint8_t> known(grid.node_count());
  for (std::size_t n = 0; n < own.size(); ++n) known[n] = products_at(n, chains, own[n]);
  const double nodes = double(std::count(known.begin(), known.end(), std::uint8_t(1)));
  if (nodes == 0) return out;

  out.cov.assign(grid.node_count(), {static_cast<float>(nan_value), 0, 0});
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      Products p;
      const std::size_t n = grid.node(i, j);
      if (!mean_around(grid, own, known, i, j, p)) continue;
      if (known[n]) out.strength += (strength_of(p.xx, p.var_x) + strength_of(p.yy, p.var_y)) / (2 * nodes);
      const double xx = p.xx > std::sqrt(p.var_x) ? p.xx : 0, yy = p.yy > std::sqrt(p.var_y) ? p.yy : 0;
      const double most_xy = std::sqrt(xx * yy);
      out.cov[n] = {static_cast<float>(xx), static_cast<float>(yy),
                    static_cast<float>(std::clamp(p.xy, -most_xy, most_xy))};
    }
  const double side = std::max(2 * correlation_length, grid.spacing.maxCoeff());
  const double places = std::max(1.0, 2 * nodes * grid.spacing.x() * grid.spacing.y() / (side * side));
  out.threshold = std::max(least_strength, sure / std::sqrt(places));
  if (!(out.strength > out.threshold))
    out.cov.clear();
  else
    fill_inward(grid, out.cov);
  return out;
}

}  // namespace pivnp::piv

#include "mpm/transfer/nonlocal.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"

namespace pivnp::mpm {

namespace {

constexpr double over = 2;          // m
constexpr double least_tap = 1e-7;  // of the filter's middle

// The taps of the n-fold (a, 1 - 2a, a) with the second moment `variance` (cells^2), from the middle outward.
std::vector<double> taps(double variance) {
  const int n = std::max(1, int(std::ceil(2 * variance)));  // a <= 1/4: no tap below zero
  const double a = variance / (2 * n);
  std::vector<double> f(std::size_t(2 * n + 1), 0.0);
  const auto middle = std::size_t(n);
  f[middle] = 1;
  for (int k = 0; k < n; ++k) {
    double left = 0;
    for (std::size_t q = 0; q < f.size(); ++q) {
      const double here = f[q], right = q + 1 < f.size() ? f[q + 1] : 0;
      f[q] = here + a * (left - 2 * here + right);
      left = here;
    }
  }
  std::vector<double> half(f.begin() + std::ptrdiff_t(middle), f.end());
  while (half.size() > 1 && half.back() < least_tap * half[0]) half.pop_back();
  return half;
}

// Hats of a point's cell at its own nodes: those of its element, or (centred) the nearest one and those beside it.
template <bool centred>
void hats(double s, double* w) {
  if constexpr (centred) {
    w[0] = std::max(0.0, -s);
    w[1] = 1 - std::abs(s);
    w[2] = std::max(0.0, s);
  } else {
    w[0] = 1 - s;
    w[1] = s;
  }
}
template <bool centred>
constexpr std::size_t hat_nodes = centred ? 3 : 2;

// Calls each(point, first node, weights along x, along y) for the points of a body in these cells.
template <bool centred, class Each>
void for_body_points(const Particles& p, const Particles::Body& body, const GridState& g, Range range, Each&& each) {
  for (std::size_t s = range.begin; s < range.end; ++s)
    for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
      const std::size_t k = g.cells.order[q];
      if (k < body.begin || k >= body.end) continue;
      double wx[hat_nodes<centred>], wy[hat_nodes<centred>];
      const Vec2 at = g.natural(p, k);
      hats<centred>(at.x(), wx);
      hats<centred>(at.y(), wy);
      each(k, std::size_t(g.cells.index[s]), wx, wy);
    }
}

// The sum of f[t] (in[-t] + in[t]) over lines of n values, `stride` apart; `lines` of them, zero beyond.
void filter_lines(const std::vector<double>& f, const double* in, double* out, std::ptrdiff_t line,
                  std::ptrdiff_t lines, std::ptrdiff_t stride, std::ptrdiff_t n) {
  const double* here = in + line * stride;
  for (std::ptrdiff_t i = 0; i < n; ++i) out[i] = f[0] * here[i];
  for (std::ptrdiff_t t = 1; t < std::ptrdiff_t(f.size()); ++t) {
    const double w = f[std::size_t(t)];
    for (const std::ptrdiff_t other : {line - t, line + t}) {
      if (other < 0 || other >= lines) continue;
      const double* row = in + other * stride;
      for (std::ptrdiff_t i = 0; i < n; ++i) out[i] += w * row[i];
    }
  }
}

// The same along a line of n values.
void filter_along(const std::vector<double>& f, const double* in, double* out, std::ptrdiff_t n) {
  for (std::ptrdiff_t i = 0; i < n; ++i) out[i] = f[0] * in[i];
  for (std::ptrdiff_t t = 1; t < std::min(n, std::ptrdiff_t(f.size())); ++t) {
    const double w = f[std::size_t(t)];
    for (std::ptrdiff_t i = t; i < n; ++i) out[i] += w * in[i - t];
    for (std::ptrdiff_t i = 0; i < n - t; ++i) out[i] += w * in[i + t];
  }
}

}  // namespace

NonlocalSoftening::NonlocalSoftening(const std::vector<std::unique_ptr<Material>>& materials, const GridState& g) {
  if (std::none_of(materials.begin(), materials.end(), [](const auto& m) { return m->nonlocal_length() > 0; })) return;
  for (const auto& material : materials) {
    const double l = material->nonlocal_length();
    Filter f;
    if (l > 0)
      for (const auto& [taps_of, per_h] : {std::pair{&f.x, g.per_hx}, {&f.y, g.per_hy}})
        *taps_of = taps(0.5 * l * l * per_h * per_h - 1.0 / 3);
    filters_.push_back(std::move(f));
  }
}

void NonlocalSoftening::average(Particles& p, GridState& g, int threads) {
  if (filters_.empty() || g.cells.size() == 0) return;
  const Box box = box_of(g);
  for (const Particles::Body& body : p.bodies) {
    const Filter& f = filters_[std::size_t(body.material)];
    if (f.x.empty()) continue;
    map(p, body, box, g, threads);
    filter(f, box, g, threads);
    gather(p, body, g, threads);
  }
}

// Only the nodes of the box around the occupied cells hold anything.
NonlocalSoftening::Box NonlocalSoftening::box_of(const GridState& g) {
  const auto nx = std::ptrdiff_t(g.grid.nx);
  std::ptrdiff_t left = nx, right = -1;
  for (const std::int32_t c : g.cells.index) {
    left = std::min(left, c % nx);
    right = std::max(right, c % nx + g.width - 1);
  }
  const std::ptrdiff_t low = g.cells.index.front() / nx, high = g.cells.index.back() / nx + g.width - 1;
  return {low * nx + left, high - low + 1, right - left + 1};
}

// Sleeping points count as all others do; where some sleep, one thread maps.
void NonlocalSoftening::map(const Particles& p, const Particles::Body& body, const Box& box, GridState& g, int threads) {
  const auto nx = std::size_t(g.grid.nx);
  double *strain = g.arrays.softening_strain.data(), *volume = g.arrays.softening_volume.data();
  for (double* field : {strain, volume})
    for (std::ptrdiff_t j = 0; j < box.lines; ++j) std::fill_n(field + box.first + j * std::ptrdiff_t(nx), box.across, 0.0);
  const Array& plastic_dev = *p.history.find(plastic_strain.name);
  const auto add = [&]<bool centred>(Range range) {
    for_body_points<centred>(p, body, g, range, [&](std::size_t k, std::size_t first, const double* wx, const double* wy) {
      for (std::size_t b = 0; b < hat_nodes<centred>; ++b)
        for (std::size_t a = 0; a < hat_nodes<centred>; ++a) {
          const double v = p.volume0[k] * p.J[k] * wx[a] * wy[b];
          volume[first + b * nx + a] += v;
          strain[first + b * nx + a] += v * plastic_dev[k];
        }
    });
  };
  const auto map_range = [&](Range range, std::size_t = 0) {
    g.centred ? add.operator()<true>(range) : add.operator()<false>(range);
  };
  std::size_t mapped = 0;
  for (const Range& run : g.active.mapped.runs) mapped += run.end - run.begin;
  if (mapped == g.cells.size())
    for_bands(g.active.mapped, threads, map_range);
  else
    map_range({0, g.cells.size()});
}

void NonlocalSoftening::filter(const Filter& f, const Box& box, GridState& g, int threads) {
  const auto nx = std::ptrdiff_t(g.grid.nx);
  const auto [first, lines, across] = box;
  double *strain = g.arrays.softening_strain.data(), *volume = g.arrays.softening_volume.data();
  for (double* field : {strain, volume}) {
    double *values = field + first, *rows = g.arrays.softening_rows.data() + first;
    for_each(std::size_t(lines), threads, [&](std::size_t j) {
      filter_along(f.x, values + std::ptrdiff_t(j) * nx, rows + std::ptrdiff_t(j) * nx, across);
    });
    for_each(std::size_t(lines), threads, [&](std::size_t j) {
      filter_lines(f.y, rows, values + std::ptrdiff_t(j) * nx, std::ptrdiff_t(j), lines, nx, across);
    });
  }
  for_each(std::size_t(lines), threads, [&](std::size_t j) {
    for (std::ptrdiff_t n = first + std::ptrdiff_t(j) * nx, end = n + across; n < end; ++n)
      strain[n] = volume[n] > 0 ? strain[n] / volume[n] : 0;
  });
}

void NonlocalSoftening::gather(Particles& p, const Particles::Body& body, const GridState& g, int threads) const {
  const auto nx = std::size_t(g.grid.nx);
  const double* strain = g.arrays.softening_strain.data();
  const Array& plastic_dev = *p.history.find(plastic_strain.name);
  const auto take = [&]<bool centred>(Range range) {
    for_body_points<centred>(p, body, g, range, [&](std::size_t k, std::size_t first, const double* wx, const double* wy) {
      double mean = 0;
      for (std::size_t b = 0; b < hat_nodes<centred>; ++b)
        for (std::size_t a = 0; a < hat_nodes<centred>; ++a) mean += wx[a] * wy[b] * strain[first + b * nx + a];
      p.softened_by[k] = std::max(0.0, (1 - over) * plastic_dev[k] + over * mean);
    });
  };
  for_pieces(g, threads, [&](Range range, std::size_t) {
    g.centred ? take.operator()<true>(range) : take.operator()<false>(range);
  });
}

}  // namespace pivnp::mpm

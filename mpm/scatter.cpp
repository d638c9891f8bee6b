#include <algorithm>
#include <cmath>

#include "mpm/kernel.hpp"
#include "mpm/transfer.hpp"

namespace pivnp::mpm {

namespace {

void locate_anew(Particles& p, const GridState& g, std::size_t k) {
  if (!g.find(p.x[k], p.y[k], p.cell[k], p.xi[k], p.eta[k])) p.cell[k] = Particles::ended;
}

// Adds a point's momentum m (v + C d) to its nodes.
template <class S, bool affine>
void add_momentum(const Particles& p, const GridState& g, std::size_t k, const Line<S::width>& lx,
                  const Line<S::width>& ly, double* mass, double* px, double* py) {
  constexpr int W = S::width;
  const Vec2 h = g.grid.spacing;
  const Arms<S> ax(p.xi[k], lx), ay(p.eta[k], ly);
  for (int b = 0; b < W; ++b)
    for (int a = 0; a < W; ++a) {
      const double m = p.mass[k] * lx.w[a] * ly.w[b];
      double vx = p.vx[k], vy = p.vy[k];
      if constexpr (affine) {
        vx += p.C_xx[k] * ax.d[a] * h.x() + p.C_xy[k] * ay.d[b] * h.y();
        vy += p.C_yx[k] * ax.d[a] * h.x() + p.C_yy[k] * ay.d[b] * h.y();
      }
      const int c = b * W + a;
      if (mass) mass[c] += m;
      px[c] += m * vx;
      py[c] += m * vy;
    }
}

struct Mean {
  double xx = 0, yy = 0, xy = 0, mean = 0, volume = 0;
};

// The element's sums of V0 times stress: what `selective`, `full` and F-bar of bilinear shapes average.
Mean element_mean(const Particles& p, const GridState& g, std::size_t slot) {
  Mean sum;
  for (std::uint32_t q = g.slot_begin[slot]; q < g.slot_begin[slot + 1]; ++q) {
    const std::size_t k = g.order[q];
    const double v = p.volume0[k];
    sum.xx += v * p.tau_xx[k];
    sum.yy += v * p.tau_yy[k];
    sum.xy += v * p.tau_xy[k];
    sum.mean += v * ((p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3);
    sum.volume += v;
  }
  return sum;
}

// -integral of (sxx, syy, sxy) through the gradient at an element's centre.
void add_centre_force(double sxx, double syy, double sxy, double per_hx, double per_hy, double* fx, double* fy) {
  for (int c = 0; c < 4; ++c) {
    const double gx = (c % 2 == 0 ? -0.5 : 0.5) * per_hx, gy = (c < 2 ? -0.5 : 0.5) * per_hy;
    fx[c] -= sxx * gx + sxy * gy;
    fy[c] -= sxy * gx + syy * gy;
  }
}

template <class S>
void add_forces(const Particles& p, const GridState& g, std::size_t slot, Locking locking, double* fx, double* fy) {
  constexpr int W = S::width;
  const SlotLines<S> lines(g, slot);
  double element_pressure = 0;
  if constexpr (W == 2) {
    if (locking != Locking::none) {
      const Mean m = element_mean(p, g, slot);
      if (locking == Locking::full) return add_centre_force(m.xx, m.yy, m.xy, g.per_hx, g.per_hy, fx, fy);
      if (locking == Locking::selective) add_centre_force(m.mean, m.mean, 0, g.per_hx, g.per_hy, fx, fy);
      if (locking == Locking::fbar) element_pressure = m.mean / m.volume;
    }
  }
  for (std::uint32_t q = g.slot_begin[slot]; q < g.slot_begin[slot + 1]; ++q) {
    const std::size_t k = g.order[q];
    double change = 0;  // of the mean stress
    if (locking != Locking::none) {
      change = -(p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3;
      if (W == 3) change += p.mean[k];
      else if (locking == Locking::fbar) change += element_pressure;
    }
    const double v = p.volume0[k];
    const double sxx = v * (p.tau_xx[k] + change), syy = v * (p.tau_yy[k] + change), sxy = v * p.tau_xy[k];
    const auto lx = lines.x(p, k), ly = lines.y(p, k);
    for (int b = 0; b < W; ++b)
      for (int a = 0; a < W; ++a) {
        const double gx = lx.g[a] * ly.w[b] * g.per_hx, gy = lx.w[a] * ly.g[b] * g.per_hy;
        fx[b * W + a] -= sxx * gx + sxy * gy;
        fy[b * W + a] -= sxy * gx + syy * gy;
      }
  }
}

template <class S, bool affine>
void slot_momentum(const Particles& p, const GridState& g, std::size_t slot, double* out) {
  constexpr int N = S::width * S::width;
  const SlotLines<S> lines(g, slot);
  for (std::uint32_t q = g.slot_begin[slot]; q < g.slot_begin[slot + 1]; ++q) {
    const std::size_t k = g.order[q];
    add_momentum<S, affine>(p, g, k, lines.x(p, k), lines.y(p, k), out, out + N, out + 2 * N);
  }
}

template <class S>
void map(const Particles& p, GridState& g, const Scheme& scheme, bool momentum, bool force, int threads) {
  constexpr int N = S::width * S::width;
  const bool affine = scheme.transfer == TransferKind::apic;
  for_slots(g, threads, [&](std::size_t s) {
    double sum[GridState::quantities * N] = {};
    if (momentum && affine) slot_momentum<S, true>(p, g, s, sum);
    else if (momentum) slot_momentum<S, false>(p, g, s, sum);
    if (force) add_forces<S>(p, g, s, scheme.locking, sum + 3 * N, sum + 4 * N);
    const int first = momentum ? 0 : 3 * N;
    std::copy(sum + first, sum + GridState::quantities * N, g.slot_sums(s) + first);
  });
}

void put_momentum(Node& node, double mass, double px, double py) {
  node = Node{};
  node.mass = mass;
  const double per_mass = mass > 0 ? 1 / mass : 0;
  node.vx = px * per_mass;
  node.vy = py * per_mass;
}

}  // namespace

void locate_all(Particles& p, GridState& g) {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) locate_anew(p, g, k);
  g.rebuild(p);
}

bool locate_points(Particles& p, GridState& g, std::vector<std::uint32_t>& left, int threads) {
  bool changed = false;
  const auto n_slots = std::ptrdiff_t(g.slots());
#pragma omp parallel for num_threads(threads) schedule(static) reduction(|| : changed) if (threads > 1)
  for (std::ptrdiff_t s = 0; s < n_slots; ++s) {
    const std::int32_t cell = g.slot_cell[std::size_t(s)];
    for (std::uint32_t q = g.slot_begin[std::size_t(s)]; q < g.slot_begin[std::size_t(s) + 1]; ++q) {
      const std::size_t k = g.order[q];
      locate_anew(p, g, k);
      changed = changed || p.cell[k] != cell;
    }
  }
  if (changed)
    for (const std::uint32_t k : g.order)
      if (p.cell[k] == Particles::ended) left.push_back(k);
  return changed;
}

void map_momentum(const Particles& p, GridState& g, const Scheme& scheme, bool force, int threads) {
  with_shape(g.shape, [&](auto s) { map<decltype(s)>(p, g, scheme, true, force, threads); });
  for_nodes<5>(g, 0, threads, [&](std::uint32_t n, const double* sum) {
    put_momentum(g.node[n], sum[0], sum[1], sum[2]);
    g.node[n].fx = sum[3];
    g.node[n].fy = sum[4];
  });
}

void map_force(const Particles& p, GridState& g, const Scheme& scheme, int threads) {
  with_shape(g.shape, [&](auto s) { map<decltype(s)>(p, g, scheme, false, true, threads); });
  for_nodes<2>(g, 3, threads, [&](std::uint32_t n, const double* sum) {
    g.node[n].fx = sum[0];
    g.node[n].fy = sum[1];
  });
}

void map_acceleration(const Particles& p, GridState& g, const std::vector<double>& ax, const std::vector<double>& ay,
                      std::vector<double>& out, int threads) {
  out.assign(2 * g.grid.node_count(), 0.0);
  with_shape(g.shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr int W = S::width, N = W * W;
    for_slots(g, threads, [&](std::size_t s) {
      double* sums = g.slot_sums(s) + 3 * N;
      std::fill(sums, sums + 2 * N, 0.0);
      const SlotLines<S> lines(g, s);
      for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
        const std::size_t k = g.order[q];
        const auto lx = lines.x(p, k), ly = lines.y(p, k);
        for (int c = 0; c < N; ++c) {
          const double m = p.mass[k] * lx.w[c % W] * ly.w[c / W];
          sums[c] += m * ax[k];
          sums[N + c] += m * ay[k];
        }
      }
    });
  });
  for_nodes<2>(g, 3, threads, [&](std::uint32_t n, const double* sum) {
    g.node[n].fx += out[2 * n] = sum[0];
    g.node[n].fy += out[2 * n + 1] = sum[1];
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

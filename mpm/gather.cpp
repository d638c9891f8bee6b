#include <algorithm>
#include <cmath>

#include "mpm/kernel.hpp"
#include "mpm/transfer.hpp"

namespace pivnp::mpm {

namespace {

// The nodal values of a slot's stencil.
template <int N>
struct SlotNodes {
  double nx[N], ny[N], ax[N], ay[N];  // new velocity, change of velocity
  double bx[N], by[N];                // XPIC: filtered velocity
};

struct Velocity {
  double x = 0, y = 0;
};

// C = B D^-1 column by column; where the weights are linear, that is the gradient (and D would vanish at a node).
template <class S>
struct Affine {
  double xx = 0, xy = 0, yx = 0, yy = 0;
  Affine(const SlotLines<S>& lines, const Line<S::width>& lx, const Line<S::width>& ly, const Arms<S>& ax,
         const Arms<S>& ay, const Vec2& h, const double* vx, const double* vy) {
    constexpr int W = S::width;
    const bool linear_x = lines.linear_x(), linear_y = lines.linear_y();
    for (int b = 0; b < W; ++b)
      for (int a = 0; a < W; ++a) {
        const int c = b * W + a;
        const double wx = (linear_x ? lx.g[a] : lx.w[a] * ax.d[a] / ax.moment) * ly.w[b] / h.x();
        const double wy = (linear_y ? ly.g[b] : ly.w[b] * ay.d[b] / ay.moment) * lx.w[a] / h.y();
        xx += wx * vx[c];
        xy += wy * vx[c];
        yx += wx * vy[c];
        yy += wy * vy[c];
      }
  }
};

struct SlotResult {
  double fastest2 = 0, loss = 0;
  bool good = true;
};

template <class S, TransferKind transfer>
SlotResult gather_slot(Particles& p, GridState& g, const Scheme& scheme, std::size_t slot,
                       const SlotNodes<S::width * S::width>& nodes, double dt, bool remap) {
  constexpr int W = S::width, N = W * W;
  const SlotLines<S> lines(g, slot);
  const Vec2 h = g.grid.spacing;
  const double pic = scheme.pic_per_s > 0 ? 1 - std::exp(-scheme.pic_per_s * dt) : 0;
  const double reach2 = std::pow(std::min(h.x(), h.y()) / dt, 2);
  double px[N] = {}, py[N] = {};
  SlotResult out;
  for (std::uint32_t q = g.slot_begin[slot]; q < g.slot_begin[slot + 1]; ++q) {
    const std::size_t k = g.order[q];
    const Line<W> lx = lines.x(p, k), ly = lines.y(p, k);
    double vx = 0, vy = 0, dvx = 0, dvy = 0, bx = 0, by = 0;
    for (int b = 0; b < W; ++b)
      for (int a = 0; a < W; ++a) {
        const double w = lx.w[a] * ly.w[b];
        const int c = b * W + a;
        vx += w * nodes.nx[c];
        vy += w * nodes.ny[c];
        if constexpr (transfer != TransferKind::apic) {
          dvx += w * nodes.ax[c];
          dvy += w * nodes.ay[c];
        }
        if constexpr (transfer == TransferKind::xpic) {
          bx += w * nodes.bx[c];
          by += w * nodes.by[c];
        }
      }
    double before = 0.5 * (p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k]), after = 0;
    if constexpr (transfer == TransferKind::apic) {
      const Arms<S> ax(p.xi[k], lx), ay(p.eta[k], ly);
      before += affine_energy(p, h, k);
      const Affine<S> C(lines, lx, ly, ax, ay, h, nodes.nx, nodes.ny);
      p.C_xx[k] = C.xx;
      p.C_xy[k] = C.xy;
      p.C_yx[k] = C.yx;
      p.C_yy[k] = C.yy;
      p.vx[k] = vx;
      p.vy[k] = vy;
      after = affine_energy(p, h, k);
    } else if constexpr (transfer == TransferKind::xpic) {
      p.vx[k] = bx + dvx;
      p.vy[k] = by + dvy;
    } else {
      const double flip_x = p.vx[k] + dvx, flip_y = p.vy[k] + dvy;
      p.vx[k] = flip_x + pic * (vx - flip_x);
      p.vy[k] = flip_y + pic * (vy - flip_y);
    }
    p.x[k] += dt * vx;
    p.y[k] += dt * vy;
    const double speed2 = p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k];
    after += 0.5 * speed2;
    out.loss += p.mass[k] * (before - after);
    out.good = out.good && speed2 <= reach2 && vx * vx + vy * vy <= reach2;  // false for NaN too
    out.fastest2 = std::max(out.fastest2, speed2);
    if (!remap) continue;
    const Arms<S> ax(p.xi[k], lx), ay(p.eta[k], ly);
    for (int b = 0; b < W; ++b)
      for (int a = 0; a < W; ++a) {
        const double m = p.mass[k] * lx.w[a] * ly.w[b];
        double ux = p.vx[k], uy = p.vy[k];
        if constexpr (transfer == TransferKind::apic) {
          ux += p.C_xx[k] * ax.d[a] * h.x() + p.C_xy[k] * ay.d[b] * h.y();
          uy += p.C_yx[k] * ax.d[a] * h.x() + p.C_yy[k] * ay.d[b] * h.y();
        }
        px[b * W + a] += m * ux;
        py[b * W + a] += m * uy;
      }
  }
  if (remap) {
    double* sums = g.slot_sums(slot);
    std::copy(px, px + N, sums + N);
    std::copy(py, py + N, sums + 2 * N);
  }
  return out;
}

template <class S>
GatherSums gather(Particles& p, GridState& g, const Scheme& scheme, double dt, const std::vector<double>& filtered,
                  bool remap, int threads) {
  constexpr int N = S::width * S::width;
  std::vector<SlotResult> results(g.slots());
  for_slots(g, threads, [&](std::size_t s) {
    std::size_t at[9];
    g.stencil_nodes(s, at);
    SlotNodes<N> nodes;
    for (int c = 0; c < N; ++c) {
      const Node& node = g.node[at[c]];
      nodes.nx[c] = node.nx;
      nodes.ny[c] = node.ny;
      nodes.ax[c] = node.nx - node.vx;
      nodes.ay[c] = node.ny - node.vy;
      nodes.bx[c] = filtered.empty() ? 0 : filtered[2 * at[c]];
      nodes.by[c] = filtered.empty() ? 0 : filtered[2 * at[c] + 1];
    }
    results[s] =
        scheme.transfer == TransferKind::apic   ? gather_slot<S, TransferKind::apic>(p, g, scheme, s, nodes, dt, remap)
        : scheme.transfer == TransferKind::xpic ? gather_slot<S, TransferKind::xpic>(p, g, scheme, s, nodes, dt, remap)
                                                : gather_slot<S, TransferKind::flip>(p, g, scheme, s, nodes, dt, remap);
  });
  GatherSums sums;
  for (const SlotResult& r : results) {
    sums.kinetic_loss += r.loss;
    sums.good = sums.good && r.good;
    sums.fastest2 = std::max(sums.fastest2, r.fastest2);
  }
  return sums;
}

// P v: from the nodes to the points and back. `v`: x, y of every node of the grid.
template <class S>
void project(const Particles& p, GridState& g, const std::vector<double>& v, std::vector<double>& out, int threads) {
  constexpr int W = S::width, N = W * W;
  for_slots(g, threads, [&](std::size_t s) {
    std::size_t at[9];
    g.stencil_nodes(s, at);
    const SlotLines<S> lines(g, s);
    double* sums = g.slot_sums(s);
    std::fill(sums + N, sums + 3 * N, 0.0);
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      const auto lx = lines.x(p, k), ly = lines.y(p, k);
      Velocity point;
      for (int c = 0; c < N; ++c) {
        const double w = lx.w[c % W] * ly.w[c / W];
        point.x += w * v[2 * at[c]];
        point.y += w * v[2 * at[c] + 1];
      }
      for (int c = 0; c < N; ++c) {
        const double m = p.mass[k] * lx.w[c % W] * ly.w[c / W];
        sums[N + c] += m * point.x;
        sums[2 * N + c] += m * point.y;
      }
    }
  });
  for_nodes<2>(g, 1, threads, [&](std::uint32_t n, const double* sum) {
    const double per_mass = g.node[n].mass > 0 ? 1 / g.node[n].mass : 0;
    out[2 * n] = sum[0] * per_mass;
    out[2 * n + 1] = sum[1] * per_mass;
  });
}

}  // namespace

GatherSums gather_velocity(Particles& p, GridState& g, const Scheme& scheme, double dt,
                           const std::vector<double>& filtered, bool remap, int threads) {
  const GatherSums sums = with_shape(
      g.shape, [&](auto s) { return gather<decltype(s)>(p, g, scheme, dt, filtered, remap, threads); });
  if (remap)
    for_nodes<2>(g, 1, threads, [&](std::uint32_t n, const double* sum) {
      Node& node = g.node[n];
      const double per_mass = node.mass > 0 ? 1 / node.mass : 0;
      node.ux = sum[0] * per_mass;
      node.uy = sum[1] * per_mass;
    });
  return sums;
}

void filtered_velocity(const Particles& p, GridState& g, int order, std::vector<double>& out, int threads) {
  out.assign(2 * g.grid.node_count(), 0.0);
  std::vector<double> rest(out.size(), 0.0), projected(out.size(), 0.0);
  for (const std::uint32_t n : g.nodes) {
    rest[2 * n] = out[2 * n] = g.node[n].vx;
    rest[2 * n + 1] = out[2 * n + 1] = g.node[n].vy;
  }
  for (int l = 1; l < order; ++l) {
    with_shape(g.shape, [&](auto s) { project<decltype(s)>(p, g, rest, projected, threads); });
    for (const std::uint32_t n : g.nodes)
      for (const std::size_t c : {2 * std::size_t(n), 2 * std::size_t(n) + 1}) {
        rest[c] -= projected[c];
        out[c] += rest[c];
      }
  }
}

double hourglass_energy(const GridState& g) {
  if (g.width != 2) return 0;
  double sum = 0;
  for (std::size_t s = 0; s < g.slots(); ++s) {
    std::size_t at[9];
    g.stencil_nodes(s, at);
    const Node &a = g.node[at[0]], &b = g.node[at[1]], &c = g.node[at[2]], &d = g.node[at[3]];
    const double x = 0.25 * (a.vx - b.vx - c.vx + d.vx), y = 0.25 * (a.vy - b.vy - c.vy + d.vy);
    const double* mass = g.sums.data() + s * std::size_t(GridState::quantities * g.stencil);
    sum += 0.5 * (mass[0] + mass[1] + mass[2] + mass[3]) * (x * x + y * y);
  }
  return sum;
}

}  // namespace pivnp::mpm

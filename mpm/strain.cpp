#include <cmath>

#include "mpm/kernel.hpp"
#include "mpm/transfer.hpp"

namespace pivnp::mpm {

namespace {

struct Gradient {
  double xx = 0, xy = 0, yx = 0, yy = 0;  // d v_a / d x_b times the step
};

double log_det(const Gradient& G) { return std::log1p(G.xx + G.yy + G.xx * G.yy - G.xy * G.yx); }

// f = I + G = V R: rotation by the angle t with 2 tan(t/2) = spin, log strain ln V. Exact: a step that turns the point
// rigidly, however far, strains it by nothing.
struct Polar {
  double xx, yy, xy, spin;
};
Polar polar(const Gradient& G) {
  const double a = 2 + G.xx + G.yy, b = G.yx - G.xy;
  const double r = std::sqrt(a * a + b * b), cos = a / r, sin = b / r;
  // V = f R^T; the parts of V - I, without cancellation.
  const double vxx = G.xx * cos - G.xy * sin - b * b / (r * (r + a));
  const double vyy = G.yx * sin + G.yy * cos - b * b / (r * (r + a));
  const double vxy = (1 + G.xx) * sin + G.xy * cos;
  const double mean = 0.5 * (vxx + vyy), half = 0.5 * (vxx - vyy), radius2 = half * half + vxy * vxy;
  // ln V = 1/2 ln det V I + atanh(q)/q dev V/(1 + mean), q = radius/(1 + mean).
  const double per = 1 / (1 + mean), q2 = radius2 * per * per;
  double factor = 1 + q2 * (1.0 / 3 + q2 * (1.0 / 5 + q2 / 7));
  if (q2 > 1e-3) factor = std::atanh(std::sqrt(q2)) / std::sqrt(q2);
  const double log_mean = 0.5 * std::log1p(2 * mean + mean * mean - radius2);
  return {log_mean + factor * half * per, log_mean - factor * half * per, factor * vxy * per, 2 * b / (r + a)};
}

// `theta`: the averaged volumetric increment, in place of the point's own; `average`: is there one?
void strain_point(Particles& p, std::size_t k, const Gradient& G, bool average, double theta) {
  const Polar e = polar(G);
  const double own = e.xx + e.yy;
  const double shift = average ? (theta - own) / 3 : 0;
  p.de_xx[k] = e.xx + shift;
  p.de_yy[k] = e.yy + shift;
  p.de_zz[k] = shift;
  p.de_xy[k] = e.xy;
  p.spin[k] = e.spin;
}

void record_point(Particles& p, std::size_t k, const Gradient& G) {
  const double a = p.F_xx[k], b = p.F_xy[k], c = p.F_yx[k], d = p.F_yy[k];
  p.F_xx[k] = a + G.xx * a + G.xy * c;
  p.F_xy[k] = b + G.xx * b + G.xy * d;
  p.F_yx[k] = c + G.yx * a + G.yy * c;
  p.F_yy[k] = d + G.yx * b + G.yy * d;
  p.J[k] *= std::exp(p.de_xx[k] + p.de_yy[k] + p.de_zz[k]);
}

template <class S>
Gradient gradient_at(const GridState& g, const std::size_t* at, const Line<S::width>& lx, const Line<S::width>& ly,
                     double sx, double sy) {
  constexpr int W = S::width;
  Gradient G;
  for (int b = 0; b < W; ++b)
    for (int a = 0; a < W; ++a) {
      const Node& n = g.node[at[b * W + a]];
      const double gx = lx.g[a] * ly.w[b] * sx, gy = lx.w[a] * ly.g[b] * sy;
      G.xx += n.ux * gx;
      G.xy += n.ux * gy;
      G.yx += n.uy * gx;
      G.yy += n.uy * gy;
    }
  return G;
}

// Bilinear shapes: everything inside one element.
void strain_element(Particles& p, const GridState& g, Locking locking, std::size_t s, double dt, bool record) {
  using S = BilinearShape;
  std::size_t at[9];
  g.stencil_nodes(s, at);
  const SlotLines<S> lines(g, s);
  const double sx = dt * g.per_hx, sy = dt * g.per_hy;
  const Line<2> middle = S::line(0.5, 0, false, false);
  const Gradient centre = gradient_at<S>(g, at, middle, middle, sx, sy);
  double theta = log_det(centre);
  if (locking == Locking::fbar) {
    double sum = 0, volume = 0;
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      sum += p.volume0[k] * log_det(gradient_at<S>(g, at, lines.x(p, k), lines.y(p, k), sx, sy));
      volume += p.volume0[k];
    }
    theta = sum / volume;
  }
  for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
    const std::size_t k = g.order[q];
    const Gradient own = gradient_at<S>(g, at, lines.x(p, k), lines.y(p, k), sx, sy);
    strain_point(p, k, locking == Locking::full ? centre : own, locking != Locking::none, theta);
    if (record) record_point(p, k, own);
  }
}

// P of three-node shapes applied to `values`: to the nodes by hats, weighted by V0, and back.
void average_by_hats(const Particles& p, GridState& g, std::vector<double>& values, int threads) {
  constexpr int N = 9;
  for_slots(g, threads, [&](std::size_t s) {
    double* sums = g.slot_sums(s);
    std::fill(sums + 3 * N, sums + 5 * N, 0.0);
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      double hx[3], hy[3];
      hat(p.xi[k], hx);
      hat(p.eta[k], hy);
      for (int c = 0; c < N; ++c) {
        const double v = p.volume0[k] * hx[c % 3] * hy[c / 3];
        sums[3 * N + c] += v * values[k];
        sums[4 * N + c] += v;
      }
    }
  });
  // Node::dx is free at this point of the step.
  for_nodes<2>(g, 3, threads,
               [&](std::uint32_t n, const double* sum) { g.node[n].dx = sum[1] > 0 ? sum[0] / sum[1] : 0; });
  for_slots(g, threads, [&](std::size_t s) {
    std::size_t at[9];
    g.stencil_nodes(s, at);
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      double hx[3], hy[3], sum = 0;
      hat(p.xi[k], hx);
      hat(p.eta[k], hy);
      for (int c = 0; c < N; ++c) sum += hx[c % 3] * hy[c / 3] * g.node[at[c]].dx;
      values[k] = sum;
    }
  });
}

template <class S>
void strain_splines(Particles& p, GridState& g, Locking locking, double dt, bool record, int threads) {
  const bool average = locking == Locking::fbar;
  const double sx = dt * g.per_hx, sy = dt * g.per_hy;
  for_slots(g, threads, [&](std::size_t s) {
    std::size_t at[9];
    g.stencil_nodes(s, at);
    const SlotLines<S> lines(g, s);
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      const Gradient G = gradient_at<S>(g, at, lines.x(p, k), lines.y(p, k), sx, sy);
      if (!average) {
        strain_point(p, k, G, false, 0);
        if (record) record_point(p, k, G);
        continue;
      }
      p.G_xx[k] = G.xx;
      p.G_xy[k] = G.xy;
      p.G_yx[k] = G.yx;
      p.G_yy[k] = G.yy;
      p.mean[k] = log_det(G);
    }
  });
  if (!average) return;
  average_by_hats(p, g, p.mean, threads);
  for_slots(g, threads, [&](std::size_t s) {
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      const Gradient G{p.G_xx[k], p.G_xy[k], p.G_yx[k], p.G_yy[k]};
      strain_point(p, k, G, true, p.mean[k]);
      if (record) record_point(p, k, G);
    }
  });
}

}  // namespace

void average_mean_stress(Particles& p, GridState& g, const Scheme& scheme, int threads) {
  if (g.width == 2 || scheme.locking != Locking::fbar) return;
  for_slots(g, threads, [&](std::size_t s) {
    for (std::uint32_t q = g.slot_begin[s]; q < g.slot_begin[s + 1]; ++q) {
      const std::size_t k = g.order[q];
      p.mean[k] = (p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / 3;
    }
  });
  average_by_hats(p, g, p.mean, threads);
}

void strain_points(Particles& p, GridState& g, const Scheme& scheme, double dt, bool record, int threads) {
  if (g.shape == ShapeKind::bilinear)
    for_slots(g, threads, [&](std::size_t s) { strain_element(p, g, scheme.locking, s, dt, record); });
  else if (g.shape == ShapeKind::gimp)
    strain_splines<GimpShape>(p, g, scheme.locking, dt, record, threads);
  else
    strain_splines<BSplineShape>(p, g, scheme.locking, dt, record, threads);
}

}  // namespace pivnp::mpm

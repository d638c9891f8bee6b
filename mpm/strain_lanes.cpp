// A.12: log strain and rotation of the step at the points, and the averages against locking.
#include "mpm/finite_strain.hpp"
#include "mpm/lanes.hpp"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/strain_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

struct LaneGradient {
  V xx, xy, yx, yy;
};
struct LanePolar {
  V trace, half, xy, spin;  // of the log strain; half: (xx - yy)/2
};

constexpr double small_change = 0.02;  // of volume: up to here the series hold to the last bit
constexpr double small_strain2 = 1e-3;  // as in polar()

HWY_INLINE V det_change(const LaneGradient& G) {
  return G.xx + G.yy + hn::NegMulAdd(G.xy, G.yx, G.xx * G.yy);
}

template <class Each>
HWY_INLINE void for_lanes(const LaneGradient& G, Each&& each) {
  const D d;
  HWY_ALIGN double xx[n_lanes], xy[n_lanes], yx[n_lanes], yy[n_lanes];
  hn::Store(G.xx, d, xx);
  hn::Store(G.xy, d, xy);
  hn::Store(G.yx, d, yx);
  hn::Store(G.yy, d, yy);
  for (std::size_t l = 0; l < n_lanes; ++l) each(l, Gradient{xx[l], xy[l], yx[l], yy[l]});
}

// ln(1 + x) of small x: 2 artanh(x/(2 + x)).
HWY_INLINE V small_log1p(V x) {
  const V s = x / (set(2) + x), s2 = s * s;
  const V series = hn::MulAdd(s2, hn::MulAdd(s2, hn::MulAdd(s2, set(2.0 / 7), set(2.0 / 5)), set(2.0 / 3)), set(2));
  return s * series;
}

HWY_INLINE V lane_log_det(const LaneGradient& G) {
  const D d;
  const V x = det_change(G);
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(hn::Abs(x), set(small_change))))) return small_log1p(x);
  HWY_ALIGN double out[n_lanes];
  for_lanes(G, [&](std::size_t l, const Gradient& g) { out[l] = log_det(g); });
  return hn::Load(d, out);
}

HWY_INLINE V lane_exp(V x) {
  const D d;
  if (HWY_LIKELY(hn::AllTrue(d, hn::Le(hn::Abs(x), set(small_change))))) {
    V sum = set(1.0 / 5040);
    for (const double c : {1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0}) sum = hn::MulAdd(sum, x, set(c));
    return sum;
  }
  HWY_ALIGN double out[n_lanes];
  hn::Store(x, d, out);
  for (double& v : out) v = std::exp(v);
  return hn::Load(d, out);
}

// polar() in lanes.
HWY_INLINE LanePolar lane_polar(const LaneGradient& G, V log_det_f, V change) {
  const D d;
  const V one = set(1), half_of = set(0.5);
  const V a = set(2) + G.xx + G.yy, b = G.yx - G.xy, b2 = b * b;
  const V r = hn::Sqrt(hn::MulAdd(a, a, b2)), ra = r + a, inverse = one / (r * ra);
  const V per_r = ra * inverse, cos = a * per_r, sin = b * per_r, below = b2 * inverse;
  const V vxx = hn::MulSub(G.xx, cos, hn::MulAdd(G.xy, sin, below));
  const V vyy = hn::MulAdd(G.yx, sin, hn::MulSub(G.yy, cos, below));
  const V vxy = hn::MulAdd(one + G.xx, sin, G.xy * cos);
  const V mean = half_of * (vxx + vyy), half = half_of * (vxx - vyy);
  const V per = one / (one + mean), q2 = hn::MulAdd(half, half, vxy * vxy) * per * per;
  const M small = hn::And(hn::Le(hn::Abs(change), set(small_change)), hn::Le(q2, set(small_strain2)));
  if (HWY_LIKELY(hn::AllTrue(d, small))) {
    const V factor =
        hn::MulAdd(q2, hn::MulAdd(q2, hn::MulAdd(q2, set(1.0 / 7), set(1.0 / 5)), set(1.0 / 3)), one) * per;
    return {log_det_f, factor * half, factor * vxy, set(2) * b * r * inverse};
  }
  HWY_ALIGN double trace[n_lanes], half_lane[n_lanes], xy[n_lanes], spin[n_lanes];
  for_lanes(G, [&](std::size_t l, const Gradient& g) {
    const Polar e = polar(g);
    trace[l] = e.xx + e.yy;
    half_lane[l] = 0.5 * (e.xx - e.yy);
    xy[l] = e.xy;
    spin[l] = e.spin;
  });
  return {hn::Load(d, trace), hn::Load(d, half_lane), hn::Load(d, xy), hn::Load(d, spin)};
}

template <class S>
HWY_INLINE LaneGradient gradient(const TileLines<S>& l, const Node* base, int nx, double sx, double sy) {
  constexpr int W = S::W;
  V wx[W], wy[W], gx[W], gy[W];
  for (int b = 0; b < W; ++b) {
    const Node* row = base + b * nx;
    wx[b] = row_sum<W>(l.x.w, row, &Node::ux);
    wy[b] = row_sum<W>(l.x.w, row, &Node::uy);
    gx[b] = row_sum<W>(l.x.g, row, &Node::ux);
    gy[b] = row_sum<W>(l.x.g, row, &Node::uy);
  }
  const V x = set(sx), y = set(sy);
  return {dot<W>(l.y.w, gx) * x, dot<W>(l.y.g, wx) * y, dot<W>(l.y.w, gy) * x, dot<W>(l.y.g, wy) * y};
}

void average_strain_slots(ShapeKind shape, double dt, const PointView& p, const CellView& c, SlotRange slots) {
  with_lanes(shape, [&](auto kind) HWY_ATTR {
    using S = decltype(kind);
    if constexpr (S::W == 3)
      for (std::size_t s = slots.begin; s < slots.end; ++s) {
        Node* base = c.node + c.slot_cell[s];
        for_tiles(c, s, [&](const auto& t) HWY_ATTR {
          const TileLines<S> l(p, c.slot_fold[s], t);
          const V theta = lane_log_det(gradient(l, base, c.nx, dt * c.per_hx, dt * c.per_hy));
          V hx[3], hy[3], value[9], volume[9];
          hat_lanes(l.xi, hx);
          hat_lanes(l.eta, hy);
          const V v = joined_volume(p, t);
          for (int n = 0; n < 9; ++n) {
            volume[n] = v * hx[n % 3] * hy[n / 3];
            value[n] = volume[n] * theta;
          }
          add_pairs<9>(value, volume, [&](int n) { return &base[n / 3 * c.nx + n % 3].dx; });
        });
      }
  });
}

// The gradient at an element's centre.
HWY_INLINE Gradient centre_gradient(const Node* base, int nx, double sx, double sy) {
  const Node &a = base[0], &b = base[1], &e = base[nx], &f = base[nx + 1];
  return {0.5 * sx * (b.ux - a.ux + f.ux - e.ux), 0.5 * sy * (e.ux - a.ux + f.ux - b.ux),
          0.5 * sx * (b.uy - a.uy + f.uy - e.uy), 0.5 * sy * (e.uy - a.uy + f.uy - b.uy)};
}

template <class S>
struct Straining {
  const StrainJob& job;
  const PointView& p;
  const CellView& c;
  const Increments& out;
  std::uint32_t first;  // place in `order` of the first increment
  double sx = job.dt * c.per_hx, sy = job.dt * c.per_hy;

  template <class Tile>
  HWY_INLINE void tile(const Tile& t, std::uint32_t place, const Node* base, unsigned fold, double theta_of_element,
                       const LaneGradient* centre) const {
    const TileLines<S> l(p, fold, t);
    const LaneGradient own = gradient(l, base, c.nx, sx, sy);
    const LaneGradient& G = centre ? *centre : own;
    const V change = det_change(G);
    const LanePolar e = lane_polar(G, lane_log_det(G), change);
    const V mean = set(0.5) * e.trace;
    V shift = zero(), theta = zero();
    if (job.locking != Locking::none) {
      if constexpr (S::W == 2) {
        theta = set(theta_of_element);
        if (job.locking == Locking::fbar) theta = hn::IfThenElse(stands_open(p, t), e.trace, theta);
      } else {
        V hx[3], hy[3], row[3];
        hat_lanes(l.xi, hx);
        hat_lanes(l.eta, hy);
        for (int b = 0; b < 3; ++b) row[b] = row_sum<3>(hx, base + b * c.nx, &Node::dx);
        theta = hn::IfThenElse(stands_open(p, t), e.trace, dot<3>(hy, row));
      }
      shift = (theta - e.trace) * set(1.0 / 3);
    }
    const D d;
    const std::size_t at = place - first;
    hn::StoreU(mean + e.half + shift, d, out.xx + at);
    hn::StoreU(mean - e.half + shift, d, out.yy + at);
    hn::StoreU(shift, d, out.zz + at);
    hn::StoreU(e.xy, d, out.xy + at);
    hn::StoreU(e.spin, d, out.spin + at);
    if (!job.record) return;
    const V F_xx = t.load(p.F_xx), F_xy = t.load(p.F_xy), F_yx = t.load(p.F_yx), F_yy = t.load(p.F_yy);
    t.store(F_xx + hn::MulAdd(own.xx, F_xx, own.xy * F_yx), p.F_xx);
    t.store(F_xy + hn::MulAdd(own.xx, F_xy, own.xy * F_yy), p.F_xy);
    t.store(F_yx + hn::MulAdd(own.yx, F_xx, own.yy * F_yx), p.F_yx);
    t.store(F_yy + hn::MulAdd(own.yx, F_xy, own.yy * F_yy), p.F_yy);
    const V J = t.load(p.J);
    t.store(job.locking == Locking::none ? hn::MulAdd(J, change, J) : J * lane_exp(theta), p.J);
  }

  // Bilinear F-bar: the element's mean of ln det f, weights V0.
  HWY_INLINE double element_average(std::size_t s, const Node* base) const {
    V sum = zero(), volume = zero();
    for_tiles(c, s, [&](const auto& t) HWY_ATTR {
      const TileLines<S> l(p, c.slot_fold[s], t);
      const V v = joined_volume(p, t);
      sum = hn::MulAdd(v, lane_log_det(gradient(l, base, c.nx, sx, sy)), sum);
      volume = volume + v;
    });
    return sum_of(sum) / sum_of(volume);
  }

  HWY_INLINE void slot(std::size_t s) const {
    const Node* base = c.node + c.slot_cell[s];
    double theta = 0;
    LaneGradient centre{zero(), zero(), zero(), zero()};
    if constexpr (S::W == 2) {
      if (job.locking == Locking::fbar) {
        theta = element_average(s, base);
      } else if (job.locking != Locking::none) {
        const Gradient G = centre_gradient(base, c.nx, sx, sy);
        centre = {set(G.xx), set(G.xy), set(G.yx), set(G.yy)};
        theta = hn::GetLane(lane_log_det(centre));
      }
    }
    const LaneGradient* by = job.locking == Locking::full ? &centre : nullptr;
    for_placed_tiles(c, s, [&](const auto& t, std::uint32_t q) HWY_ATTR { tile(t, q, base, c.slot_fold[s], theta, by); });
  }
};

void strain_slots(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, SlotRange slots,
                  const Increments& out) {
  with_lanes(shape, [&](auto kind) HWY_ATTR {
    const Straining<decltype(kind)> strain{job, p, c, out, c.slot_begin[slots.begin]};
    for (std::size_t s = slots.begin; s < slots.end; ++s) strain.slot(s);
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(average_strain_slots);
HWY_EXPORT(strain_slots);

void average_strain_lanes(ShapeKind shape, double dt, const PointView& p, const CellView& c, SlotRange slots) {
  HWY_DYNAMIC_DISPATCH(average_strain_slots)(shape, dt, p, c, slots);
}
void strain_lanes(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, SlotRange slots,
                  const Increments& out) {
  HWY_DYNAMIC_DISPATCH(strain_slots)(shape, job, p, c, slots, out);
}

}  // namespace pivnp::mpm
#endif

// Cubic B-splines, several particles at a time: TensorGather<Spline<3>> where all of a particle's 4 x 4 nodes are usable.
#include <cstring>
#include <limits>

#include "pivnp/np/fast_step.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/np/fast_spline.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "pivnp/np/fast_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::np::HWY_NAMESPACE {

// The coefficients around a cell, rows upward.
struct Stencil {
  V u[4][4], v[4][4];
};

// A particle's four coefficients of a row lie side by side. Copied and taken apart they cost an AMD Zen three quarters
// of what gathers do, and an Intel Xeon as much.
HWY_INLINE void load(const FastField& f, V i, V j, Stencil& s) {
  const D d;
  constexpr std::size_t most = hn::MaxLanes(D()), row = 4;
  const std::ptrdiff_t wide = f.nx + 2;
  HWY_ALIGN std::int32_t first[most];
  HWY_ALIGN std::uint64_t rows[4][row * most];
  hn::Store(hn::DemoteTo(DI32(), hn::Add(hn::Mul(j, hn::Set(d, double(wide))), i)), DI32(), first);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k)
    for (int b = 0; b < 4; ++b)
      std::memcpy(rows[b] + row * k, f.nodes.data() + (first[k] + b * wide), row * sizeof(std::uint64_t));
  for (int b = 0; b < 4; ++b) {
    hn::Vec<DU64> node[row];
    hn::LoadInterleaved4(DU64(), rows[b], node[0], node[1], node[2], node[3]);
    for (std::size_t a = 0; a < row; ++a) split(node[a], s.u[b][a], s.v[b][a]);
  }
}

// Weights of the four coefficients at t in a cell, six times: the sixths go into one factor.
HWY_INLINE void weigh(V t, V one, V* w, V* dw) {
  const D d;
  const V r = hn::Sub(one, t), three = hn::Set(d, 3), six = hn::Set(d, 6), four = hn::Set(d, 4), twelve = hn::Set(d, 12), nine = hn::Set(d, 9);
  const V tt = hn::Mul(t, t), rr = hn::Mul(r, r);
  w[0] = hn::Mul(rr, r);
  w[1] = hn::Add(four, hn::Mul(tt, hn::Sub(hn::Mul(three, t), six)));
  w[2] = hn::Add(four, hn::Mul(rr, hn::Sub(hn::Mul(three, r), six)));
  w[3] = hn::Mul(tt, t);
  dw[0] = hn::Neg(hn::Mul(three, rr));
  dw[1] = hn::Mul(t, hn::Sub(hn::Mul(nine, t), twelve));
  dw[2] = hn::Mul(r, hn::Sub(twelve, hn::Mul(nine, r)));
  dw[3] = hn::Mul(three, tt);
}

HWY_INLINE V sum(const V* w, const V* c) {
  return hn::Add(product(w[0], c[0], w[1], c[1]), product(w[2], c[2], w[3], c[3]));
}

// Value and slopes (by cells) of one component.
HWY_INLINE void evaluate(const V (&c)[4][4], const V* wx, const V* dx, const V* wy, const V* dy, V& value, V& along_x, V& along_y) {
  const V scale = hn::Set(D(), 1.0 / 36);
  V rows[4], slopes[4];
  for (int b = 0; b < 4; ++b) rows[b] = sum(wx, c[b]), slopes[b] = sum(dx, c[b]);
  value = hn::Mul(scale, sum(wy, rows));
  along_x = hn::Mul(scale, sum(wy, slopes));
  along_y = hn::Mul(scale, sum(dy, rows));
}

HWY_INLINE Read read_spline(const FastField& f, const Limits& l, V sx, V sy, M wanted) {
  const D d;
  V mx = sx, my = sy;
  V i = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sx), l.cells_x));
  V j = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sy), l.cells_y));
  Stencil c;
  load(f, i, j, c);
  const V hx = hn::Set(d, 0.5 * f.per_spacing_x), hy = hn::Set(d, 0.5 * f.per_spacing_y);
  const V ihx = hn::Set(d, f.per_spacing_x), ihy = hn::Set(d, f.per_spacing_y);
  const V tolerance = hn::Add(hn::Set(d, 1e-14), hn::Mul(hn::Set(d, 4 * std::numeric_limits<double>::epsilon()), hn::Add(sx, sy)));
  M settled = hn::Not(wanted), found = hn::And(wanted, settled);
  Read r;
  V uxi, ueta, vxi, veta, ax = l.zero, ay = l.zero;
  const V last_step = hn::Set(d, 1e-7);
  for (int n = 0; n < 10; ++n) {
    V wx[4], dx[4], wy[4], dy[4];
    r.xi = hn::Sub(mx, i), r.eta = hn::Sub(my, j);
    weigh(r.xi, l.one, wx, dx);
    weigh(r.eta, l.one, wy, dy);
    evaluate(c.u, wx, dx, wy, dy, r.dx, uxi, ueta);
    evaluate(c.v, wx, dx, wy, dy, r.dy, vxi, veta);
    if (!f.central) {
      found = wanted;
      break;
    }
    const V rx = hn::Sub(hn::Add(sx, hn::Mul(hx, r.dx)), mx), ry = hn::Sub(hn::Add(sy, hn::Mul(hy, r.dy)), my);
    const M now = hn::AndNot(settled, hn::Le(hn::Max(hn::Abs(rx), hn::Abs(ry)), tolerance));
    found = hn::Or(found, now);
    settled = hn::Or(settled, now);
    if (hn::AllTrue(d, settled)) break;
    const V a = hn::Sub(l.one, hn::Mul(hx, uxi)), b = hn::Mul(hx, ueta);  // the negatives of b and c in the scalar step
    const V e = hn::Mul(hy, vxi), g = hn::Sub(l.one, hn::Mul(hy, veta));
    const V det = hn::Sub(hn::Mul(a, g), hn::Mul(b, e));
    const V inverse = hn::Div(l.one, det);
    const V px = hn::Mul(hn::Add(hn::Mul(g, rx), hn::Mul(b, ry)), inverse);
    const V py = hn::Mul(hn::Add(hn::Mul(a, ry), hn::Mul(e, rx)), inverse);
    // The step that remains is taken along the gradient: what that leaves is of the order of its square.
    const M last = hn::AndNot(settled, hn::Le(hn::Max(hn::Abs(px), hn::Abs(py)), last_step));
    settled = hn::Or(settled, hn::Not(hn::Gt(det, hn::Set(d, 0.05))));  // where the scalar step does not trust Newton either
    ax = hn::IfThenElse(last, product(uxi, px, ueta, py), ax);
    ay = hn::IfThenElse(last, product(vxi, px, veta, py), ay);
    found = hn::Or(found, last);
    settled = hn::Or(settled, last);
    if (hn::AllTrue(d, settled)) break;
    mx = hn::IfThenElse(settled, mx, hn::Add(mx, px));
    my = hn::IfThenElse(settled, my, hn::Add(my, py));
    // Lanes that have left the grid (or hold NaN) are given up, so that they keep none of the others.
    settled = hn::Or(settled, hn::Not(inside(l, mx, my)));
    if (hn::AllTrue(d, settled)) break;
    const V ni = hn::IfThenElse(settled, i, hn::Min(hn::Floor(mx), l.cells_x));
    const V nj = hn::IfThenElse(settled, j, hn::Min(hn::Floor(my), l.cells_y));
    if (hn::AllTrue(d, hn::And(hn::Eq(ni, i), hn::Eq(nj, j)))) continue;
    i = ni, j = nj;
    load(f, i, j, c);
  }
  r.i = i, r.j = j, r.known = found;
  r.dx = hn::Add(r.dx, ax), r.dy = hn::Add(r.dy, ay);
  r.g = {hn::Mul(uxi, ihx), hn::Mul(ueta, ihy), hn::Mul(vxi, ihx), hn::Mul(veta, ihy)};
  if (f.centre_gradient) {
    V wx[4], dx[4], wy[4], dy[4], none;
    const V half = hn::Set(d, 0.5);
    weigh(half, l.one, wx, dx);
    weigh(half, l.one, wy, dy);
    evaluate(c.u, wx, dx, wy, dy, none, uxi, ueta);
    evaluate(c.v, wx, dx, wy, dy, none, vxi, veta);
    r.g = {hn::Mul(uxi, ihx), hn::Mul(ueta, ihy), hn::Mul(vxi, ihx), hn::Mul(veta, ihy)};
  }
  return r;
}

void StepAllSpline(const FastField& f, const FastParticles& particles) {
  const Limits l = limits_of(f);
  step_all(f, l, particles, [&](V sx, V sy, M wanted) HWY_ATTR { return read_spline(f, l, sx, sy, wanted); });
}

}  // namespace pivnp::np::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::np {

HWY_EXPORT(StepAllSpline);

void fast_spline_step(const FastField& field, const FastParticles& particles) {
  HWY_DYNAMIC_DISPATCH(StepAllSpline)(field, particles);
}

}  // namespace pivnp::np
#endif

#include "pivnp/np/fast_step.hpp"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/np/fast_step.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pivnp::np::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using DI32 = hn::Rebind<std::int32_t, D>;
using DI64 = hn::Rebind<std::int64_t, D>;
using DU64 = hn::Rebind<std::uint64_t, D>;
using DU32 = hn::Rebind<std::uint32_t, D>;
using DF32 = hn::Rebind<float, D>;

// One component in an element, as Bilinear of gather.hpp: a + b xi + c eta + e xi eta.
struct Component {
  V a, b, c, e;
};

struct Cell {
  V i, j;  // lower left node
  Component u, v;
};

// Nothing is fused: the same bits whatever the instruction set.
HWY_INLINE V at(const Component& f, V xi, V eta) {
  return hn::Add(hn::Add(f.a, hn::Mul(f.b, xi)), hn::Mul(hn::Add(f.c, hn::Mul(f.e, xi)), eta));
}

HWY_INLINE void split(hn::Vec<DU64> node, V& u, V& v) {
  const D d;
  const DU32 d32;
  const DF32 df;
  u = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(d32, node)));
  v = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(d32, hn::ShiftRight<32>(node))));
}

HWY_INLINE Component component(V lower_left, V lower_right, V upper_left, V upper_right) {
  const V b = hn::Sub(lower_right, lower_left);
  return {lower_left, b, hn::Sub(upper_left, lower_left), hn::Sub(hn::Sub(upper_right, upper_left), b)};
}

HWY_INLINE void load(const FastField& f, Cell& cell) {
  const D d;
  const hn::Vec<DI64> n = hn::PromoteTo(
      DI64(), hn::DemoteTo(DI32(), hn::Add(hn::Mul(cell.j, hn::Set(d, double(f.nx))), cell.i)));
  const DU64 du;
  const std::uint64_t* nodes = f.nodes.data();
  V u[4], v[4];
  split(hn::GatherIndex(du, nodes, n), u[0], v[0]);
  split(hn::GatherIndex(du, nodes + 1, n), u[1], v[1]);
  split(hn::GatherIndex(du, nodes + f.nx, n), u[2], v[2]);
  split(hn::GatherIndex(du, nodes + f.nx + 1, n), u[3], v[3]);
  cell.u = component(u[0], u[1], u[2], u[3]);
  cell.v = component(v[0], v[1], v[2], v[3]);
}

struct Limits {
  V zero, one, last_x, last_y, cells_x, cells_y, edge_low, edge_high;
};

HWY_INLINE M inside(const Limits& l, V sx, V sy) {
  return hn::And(hn::And(hn::Ge(sx, l.zero), hn::Le(sx, l.last_x)), hn::And(hn::Ge(sy, l.zero), hn::Le(sy, l.last_y)));
}

HWY_INLINE M contains(const Limits& l, V xi, V eta) {
  return hn::And(hn::And(hn::Ge(xi, l.edge_low), hn::Le(xi, l.edge_high)),
                 hn::And(hn::Ge(eta, l.edge_low), hn::Le(eta, l.edge_high)));
}

// Newton's method for m = s + d(m)/2 as in Gather::central; true lanes have settled.
HWY_INLINE M mid_point(const FastField& f, const Limits& l, V sx, V sy, M wanted, Cell& cell, V& mx, V& my) {
  const D d;
  const V hx = hn::Set(d, 0.5 * f.per_spacing_x), hy = hn::Set(d, 0.5 * f.per_spacing_y);
  const V tolerance = hn::Add(hn::Set(d, 1e-14), hn::Mul(hn::Set(d, 4 * std::numeric_limits<double>::epsilon()),
                                                         hn::Add(sx, sy)));
  M settled = hn::Not(wanted);  // what is not wanted shall not keep the loop going
  M found = hn::And(wanted, hn::Not(wanted));
  mx = sx;
  my = sy;
  for (int n = 0; n < 8; ++n) {
    if (n > 0) {
      const M in = inside(l, mx, my);
      const V i = hn::IfThenElse(hn::Or(settled, hn::Not(in)), cell.i, hn::Min(hn::Floor(mx), l.cells_x));
      const V j = hn::IfThenElse(hn::Or(settled, hn::Not(in)), cell.j, hn::Min(hn::Floor(my), l.cells_y));
      const M moved = hn::Or(hn::Ne(i, cell.i), hn::Ne(j, cell.j));
      if (!hn::AllFalse(d, moved)) {
        cell.i = i;
        cell.j = j;
        load(f, cell);
      }
    }
    const V xi = hn::Sub(mx, cell.i), eta = hn::Sub(my, cell.j);
    const V rx = hn::Sub(hn::Add(sx, hn::Mul(hx, at(cell.u, xi, eta))), mx);
    const V ry = hn::Sub(hn::Add(sy, hn::Mul(hy, at(cell.v, xi, eta))), my);
    const V a = hn::Sub(l.one, hn::Mul(hx, hn::Add(cell.u.b, hn::Mul(cell.u.e, eta))));
    const V b = hn::Mul(hx, hn::Add(cell.u.c, hn::Mul(cell.u.e, xi)));  // the negatives of b and c in the scalar step
    const V c = hn::Mul(hy, hn::Add(cell.v.b, hn::Mul(cell.v.e, eta)));
    const V e = hn::Sub(l.one, hn::Mul(hy, hn::Add(cell.v.c, hn::Mul(cell.v.e, xi))));
    const V inverse = hn::Div(l.one, hn::Sub(hn::Mul(a, e), hn::Mul(b, c)));
    const V px = hn::Mul(hn::Add(hn::Mul(e, rx), hn::Mul(b, ry)), inverse);
    const V py = hn::Mul(hn::Add(hn::Mul(a, ry), hn::Mul(c, rx)), inverse);
    mx = hn::IfThenElse(settled, mx, hn::Add(mx, px));
    my = hn::IfThenElse(settled, my, hn::Add(my, py));
    const V left = hn::Mul(hn::Max(hn::Abs(hn::Mul(hx, cell.u.e)), hn::Abs(hn::Mul(hy, cell.v.e))),
                           hn::Abs(hn::Mul(px, py)));
    const M now = hn::And(hn::AndNot(settled, hn::Le(left, tolerance)),
                          contains(l, hn::Sub(mx, cell.i), hn::Sub(my, cell.j)));
    found = hn::Or(found, now);
    settled = hn::Or(settled, now);
    if (hn::AllTrue(d, settled)) break;
  }
  return found;
}

struct Gradient {
  V xx, xy, yx, yy;
};

// f of one step: step_gradient() of the tracker.
HWY_INLINE Gradient step_gradient(const Gradient& g, bool central, V one) {
  if (!central) return {hn::Add(one, g.xx), g.xy, g.yx, hn::Add(one, g.yy)};
  const D d;
  const V trace = hn::Mul(hn::Set(d, 0.5), hn::Add(g.xx, g.yy));
  const V det = hn::Mul(hn::Set(d, 0.25), hn::Sub(hn::Mul(g.xx, g.yy), hn::Mul(g.xy, g.yx)));
  const V below = hn::Add(hn::Sub(one, trace), det);
  const V s = hn::IfThenElse(hn::Gt(below, hn::Zero(d)), hn::Div(one, below), hn::NaN(d));
  const V diagonal = hn::Sub(hn::Sub(one, trace), det);
  return {hn::Mul(hn::Add(diagonal, g.xx), s), hn::Mul(g.xy, s), hn::Mul(g.yx, s),
          hn::Mul(hn::Add(diagonal, g.yy), s)};
}

HWY_INLINE V product(V a, V b, V c, V e) { return hn::Add(hn::Mul(a, b), hn::Mul(c, e)); }

struct Covariance {
  V uu, vv, uv;
};

// A C A^T: carried() of the tracker.
HWY_INLINE Covariance carried(const Gradient& A, const Covariance& C) {
  const V u0 = product(A.xx, C.uu, A.xy, C.uv), u1 = product(A.xx, C.uv, A.xy, C.vv);
  const V v0 = product(A.yx, C.uu, A.yy, C.uv), v1 = product(A.yx, C.uv, A.yy, C.vv);
  return {product(u0, A.xx, u1, A.xy), product(v0, A.yx, v1, A.yy), product(u0, A.yx, u1, A.yy)};
}

// E = rho sum |w_i| C_i + (1 - rho) sum w_i^2 C_i, as Gather::read with bilinear weights.
HWY_INLINE Covariance gathered(const FastField& f, const Cell& cell, V xi, V eta, V one) {
  const D d;
  const DU64 du;
  const hn::Vec<DI64> n = hn::PromoteTo(
      DI64(), hn::DemoteTo(DI32(), hn::Add(hn::Mul(cell.j, hn::Set(d, double(f.nx))), cell.i)));
  const V x0 = hn::Sub(one, xi), y0 = hn::Sub(one, eta);
  const V rho = hn::Set(d, f.error_correlation), rest = hn::Set(d, 1 - f.error_correlation);
  const auto share = [&](V w) { return product(rho, hn::Abs(w), hn::Mul(rest, w), w); };
  const V w[4] = {share(hn::Mul(x0, y0)), share(hn::Mul(xi, y0)), share(hn::Mul(x0, eta)), share(hn::Mul(xi, eta))};
  const std::uint64_t* node = f.cov.data();
  const std::size_t above = 2 * std::size_t(f.nx), from[4] = {0, 2, above, above + 2};
  Covariance c[4];
  for (int k = 0; k < 4; ++k) {
    V none;
    const hn::Vec<DI64> at = hn::Add(n, n);
    split(hn::GatherIndex(du, node + from[k], at), c[k].uu, c[k].vv);
    split(hn::GatherIndex(du, node + from[k] + 1, at), c[k].uv, none);
  }
  const auto sum = [&](V a, V b, V e, V g) { return hn::Add(product(w[0], a, w[1], b), product(w[2], e, w[3], g)); };
  return {sum(c[0].uu, c[1].uu, c[2].uu, c[3].uu), sum(c[0].vv, c[1].vv, c[2].vv, c[3].vv),
          sum(c[0].uv, c[1].uv, c[2].uv, c[3].uv)};
}

// C1 = f C0 f^T + K E K^T, K = I (forward) or (I + f)/2 (central); lanes that are not good keep theirs.
HWY_INLINE void step_covariance(const FastField& f, const Cell& cell, V xi, V eta, const Gradient& s, M good, V one,
                                double* cov) {
  const D d;
  Covariance C, E = gathered(f, cell, xi, eta, one);
  hn::LoadInterleaved3(d, cov, C.uu, C.vv, C.uv);
  if (f.central) {
    const V half = hn::Set(d, 0.5);
    E = carried({hn::Add(half, hn::Mul(half, s.xx)), hn::Mul(half, s.xy), hn::Mul(half, s.yx),
                 hn::Add(half, hn::Mul(half, s.yy))}, E);
  }
  const Covariance before = carried(s, C);
  hn::StoreInterleaved3(hn::IfThenElse(good, hn::Add(before.uu, E.uu), C.uu),
                        hn::IfThenElse(good, hn::Add(before.vv, E.vv), C.vv),
                        hn::IfThenElse(good, hn::Add(before.uv, E.uv), C.uv), d, cov);
}

// As many particles as there are lanes.
HWY_INLINE void step_lanes(const FastField& f, const Limits& l, double* x, double* F, double* cov,
                           const std::uint8_t* status, std::uint8_t* moved, std::int32_t* element) {
  const D d;
  V px, py;
  hn::LoadInterleaved2(d, x, px, py);
  const V sx = hn::Mul(hn::Sub(px, hn::Set(d, f.origin_x)), hn::Set(d, f.per_spacing_x));
  const V sy = hn::Mul(hn::Sub(py, hn::Set(d, f.origin_y)), hn::Set(d, f.per_spacing_y));
  HWY_ALIGN double alive[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) alive[k] = status[k] == 1 || status[k] == 2;
  M wanted = hn::And(hn::Gt(hn::Load(d, alive), l.zero), inside(l, sx, sy));

  Cell cell;  // lanes that are not wanted read the first element
  cell.i = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sx), l.cells_x));
  cell.j = hn::IfThenElseZero(wanted, hn::Min(hn::Floor(sy), l.cells_y));
  load(f, cell);
  V mx = sx, my = sy;
  if (f.central) wanted = mid_point(f, l, sx, sy, wanted, cell, mx, my);

  const V xi = hn::Sub(mx, cell.i), eta = hn::Sub(my, cell.j);
  const V x1 = hn::Add(px, at(cell.u, xi, eta)), y1 = hn::Add(py, at(cell.v, xi, eta));
  const V gx = f.centre_gradient ? hn::Set(d, 0.5) : xi, gy = f.centre_gradient ? hn::Set(d, 0.5) : eta;
  const V ihx = hn::Set(d, f.per_spacing_x), ihy = hn::Set(d, f.per_spacing_y);
  const Gradient g{hn::Mul(hn::Add(cell.u.b, hn::Mul(cell.u.e, gy)), ihx),
                   hn::Mul(hn::Add(cell.u.c, hn::Mul(cell.u.e, gx)), ihy),
                   hn::Mul(hn::Add(cell.v.b, hn::Mul(cell.v.e, gy)), ihx),
                   hn::Mul(hn::Add(cell.v.c, hn::Mul(cell.v.e, gx)), ihy)};
  const Gradient s = step_gradient(g, f.central, l.one);
  V xx, yx, xy, yy;
  hn::LoadInterleaved4(d, F, xx, yx, xy, yy);
  const Gradient now{product(s.xx, xx, s.xy, yx), product(s.xx, xy, s.xy, yy), product(s.yx, xx, s.yy, yx),
                     product(s.yx, xy, s.yy, yy)};
  const V J = hn::Sub(hn::Mul(now.xx, now.yy), hn::Mul(now.xy, now.yx));
  const V all = hn::Add(hn::Add(hn::Add(J, hn::Add(x1, y1)), hn::Add(now.xx, now.xy)), hn::Add(now.yx, now.yy));
  const M good = hn::And(wanted, hn::And(hn::Gt(J, l.zero), hn::Lt(hn::Abs(all), hn::Inf(d))));

  hn::StoreInterleaved2(hn::IfThenElse(good, x1, px), hn::IfThenElse(good, y1, py), d, x);
  hn::StoreInterleaved4(hn::IfThenElse(good, now.xx, xx), hn::IfThenElse(good, now.yx, yx),
                        hn::IfThenElse(good, now.xy, xy), hn::IfThenElse(good, now.yy, yy), d, F);
  if (!f.cov.empty()) step_covariance(f, cell, xi, eta, s, good, l.one, cov);
  const V index = hn::Add(hn::Mul(cell.j, hn::Set(d, double(f.nx - 1))), cell.i);
  const DI32 di;
  hn::StoreU(hn::DemoteTo(di, index), di, element);
  HWY_ALIGN double flag[hn::MaxLanes(D())];
  hn::Store(hn::IfThenElseZero(good, l.one), d, flag);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) moved[k] = flag[k] > 0;
}

void StepAll(const FastField& f, double* x, double* F, double* cov, const std::uint8_t* status, std::size_t count,
             std::uint8_t* moved, std::int32_t* element) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const Limits l{hn::Zero(d),
                 hn::Set(d, 1.0),
                 hn::Set(d, f.nx - 1.0),
                 hn::Set(d, f.ny - 1.0),
                 hn::Set(d, f.nx - 2.0),
                 hn::Set(d, f.ny - 2.0),
                 hn::Set(d, -1e-12),
                 hn::Set(d, 1 + 1e-12)};
  std::size_t p = 0;
  for (; p + lanes <= count; p += lanes) 
    step_lanes(f, l, x + 2 * p, F + 4 * p, cov + 3 * p, status + p, moved + p, element + p);
  if (p == count) return;
  // The rest, in lanes of its own; those left over are of no particle.
  constexpr std::size_t most = hn::MaxLanes(D());
  double xs[2 * most] = {}, Fs[4 * most] = {}, covs[3 * most] = {};
  std::uint8_t alive[most] = {}, done[most];
  std::int32_t at[most];
  const std::size_t rest = count - p;
  std::copy(x + 2 * p, x + 2 * count, xs);
  std::copy(F + 4 * p, F + 4 * count, Fs);
  std::copy(cov + 3 * p, cov + 3 * count, covs);
  std::copy(status + p, status + count, alive);
  step_lanes(f, l, xs, Fs, covs, alive, done, at);
  std::copy(xs, xs + 2 * rest, x + 2 * p);
  std::copy(Fs, Fs + 4 * rest, F + 4 * p);
  std::copy(covs, covs + 3 * rest, cov + 3 * p);
  std::copy(done, done + rest, moved + p);
  std::copy(at, at + rest, element + p);
}

}  // namespace pivnp::np::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::np {

HWY_EXPORT(StepAll);

void fast_step(const FastField& field, double* x, double* F, double* cov, const std::uint8_t* status,
               std::size_t count, std::uint8_t* moved, std::int32_t* element) {
  HWY_DYNAMIC_DISPATCH(StepAll)(field, x, F, cov, status, count, moved, element);
}

}  // namespace pivnp::np
#endif

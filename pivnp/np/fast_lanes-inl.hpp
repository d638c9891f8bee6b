// What the vectorised steps of all shapes share; compiled once for every instruction set. Plain numbers only.
#if defined(PIVNP_NP_FAST_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_NP_FAST_LANES
#undef PIVNP_NP_FAST_LANES
#else
#define PIVNP_NP_FAST_LANES
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "pivnp/np/fast_step.hpp"

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

// Nothing is fused: the same bits whatever the instruction set.
HWY_INLINE void split(hn::Vec<DU64> node, V& u, V& v) {
  const D d;
  const DU32 d32;
  const DF32 df;
  u = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(d32, node)));
  v = hn::PromoteTo(d, hn::BitCast(df, hn::TruncateTo(d32, hn::ShiftRight<32>(node))));
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

// What is known of the errors at a place.
struct Errors {
  Covariance E;   // of the increment
  V u, v;         // expected error of the reading
  V gradient;     // variance of a component of the gradient
};

// read_errors() of gather.hpp with bilinear weights.
HWY_INLINE Errors errors_at(const FastField& f, V i, V j, V xi, V eta, V one) {
  const D d;
  const DU64 du;
  const hn::Vec<DI64> n =
      hn::PromoteTo(DI64(), hn::DemoteTo(DI32(), hn::Add(hn::Mul(j, hn::Set(d, double(f.nx - 1))), i)));
  const hn::Vec<DI64> at = hn::Add(n, hn::Add(n, n));
  Errors e;
  split(hn::GatherIndex(du, f.errors.data(), at), e.E.uu, e.E.vv);
  split(hn::GatherIndex(du, f.errors.data() + 1, at), e.E.uv, e.gradient);
  split(hn::GatherIndex(du, f.errors.data() + 2, at), e.u, e.v);
  if (f.error_correlation == 1) return e;
  const V x0 = hn::Sub(one, xi), y0 = hn::Sub(one, eta);
  const V squares = hn::Mul(product(x0, x0, xi, xi), product(y0, y0, eta, eta));
  const V factor = hn::Add(hn::Set(d, f.error_correlation), hn::Mul(hn::Set(d, 1 - f.error_correlation), squares));
  e.E = {hn::Mul(factor, e.E.uu), hn::Mul(factor, e.E.vv), hn::Mul(factor, e.E.uv)};
  return e;
}

// The uncertainties of Tracker's step; lanes that are not good keep theirs. F: before the step.
HWY_INLINE void step_errors(const FastField& f, const Errors& e, const Gradient& s, const Gradient& F, M good, V one,
                            const FastParticles& particles, std::size_t p) {
  const D d;
  const V half = hn::Set(d, 0.5);
  Gradient K{one, hn::Zero(d), hn::Zero(d), one};
  Covariance E = e.E;
  if (f.central) {
    K = {hn::Add(half, hn::Mul(half, s.xx)), hn::Mul(half, s.xy), hn::Mul(half, s.yx), hn::Add(half, hn::Mul(half, s.yy))};
    E = carried(K, E);
  }
  Covariance C;
  hn::LoadInterleaved3(d, particles.cov + 3 * p, C.uu, C.vv, C.uv);
  const Covariance before = carried(s, C);
  hn::StoreInterleaved3(hn::IfThenElse(good, hn::Add(before.uu, E.uu), C.uu),
                        hn::IfThenElse(good, hn::Add(before.vv, E.vv), C.vv),
                        hn::IfThenElse(good, hn::Add(before.uv, E.uv), C.uv), d, particles.cov + 3 * p);
  V bx, by;
  hn::LoadInterleaved2(d, particles.bias + 2 * p, bx, by);
  const V nx = hn::Add(product(s.xx, bx, s.xy, by), product(K.xx, e.u, K.xy, e.v));
  const V ny = hn::Add(product(s.yx, bx, s.yy, by), product(K.yx, e.u, K.yy, e.v));
  hn::StoreInterleaved2(hn::IfThenElse(good, nx, bx), hn::IfThenElse(good, ny, by), d, particles.bias + 2 * p);
  // R1 = (f:f)/2 R0 + g F0^T F0
  const V grown = hn::Mul(half, hn::Add(product(s.xx, s.xx, s.xy, s.xy), product(s.yx, s.yx, s.yy, s.yy)));
  Covariance R;
  hn::LoadInterleaved3(d, particles.cov_F + 3 * p, R.uu, R.vv, R.uv);
  const V xx = hn::Add(hn::Mul(grown, R.uu), hn::Mul(e.gradient, product(F.xx, F.xx, F.yx, F.yx)));
  const V yy = hn::Add(hn::Mul(grown, R.vv), hn::Mul(e.gradient, product(F.xy, F.xy, F.yy, F.yy)));
  const V xy = hn::Add(hn::Mul(grown, R.uv), hn::Mul(e.gradient, product(F.xx, F.xy, F.yx, F.yy)));
  hn::StoreInterleaved3(hn::IfThenElse(good, xx, R.uu), hn::IfThenElse(good, yy, R.vv),
                        hn::IfThenElse(good, xy, R.uv), d, particles.cov_F + 3 * p);
}

// What was read for the particles of the lanes.
struct Read {
  V i, j, xi, eta;  // element and place in it
  V dx, dy;
  Gradient g;
  M known;
};

HWY_INLINE Limits limits_of(const FastField& f) {
  const D d;
  return {hn::Zero(d),
          hn::Set(d, 1.0),
          hn::Set(d, f.nx - 1.0),
          hn::Set(d, f.ny - 1.0),
          hn::Set(d, f.nx - 2.0),
          hn::Set(d, f.ny - 2.0),
          hn::Set(d, -1e-12),
          hn::Set(d, 1 + 1e-12)};
}

// As many particles as there are lanes, from p on; read(sx, sy, wanted) -> Read.
template <class Reader>
HWY_INLINE void step_lanes(const FastField& f, const Limits& l, const FastParticles& particles, std::size_t p, const Reader& read) {
  const D d;
  V px, py;
  hn::LoadInterleaved2(d, particles.x + 2 * p, px, py);
  const V sx = hn::Mul(hn::Sub(px, hn::Set(d, f.origin_x)), hn::Set(d, f.per_spacing_x));
  const V sy = hn::Mul(hn::Sub(py, hn::Set(d, f.origin_y)), hn::Set(d, f.per_spacing_y));
  HWY_ALIGN double alive[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) alive[k] = particles.status[p + k] == 1 || particles.status[p + k] == 2;
  const M wanted = hn::And(hn::Gt(hn::Load(d, alive), l.zero), inside(l, sx, sy));
  const Read r = read(sx, sy, wanted);

  const V x1 = hn::Add(px, r.dx), y1 = hn::Add(py, r.dy);
  const Gradient s = step_gradient(r.g, f.central, l.one);
  V xx, yx, xy, yy;
  hn::LoadInterleaved4(d, particles.F + 4 * p, xx, yx, xy, yy);
  const Gradient now{product(s.xx, xx, s.xy, yx), product(s.xx, xy, s.xy, yy), product(s.yx, xx, s.yy, yx),
                     product(s.yx, xy, s.yy, yy)};
  const V J = hn::Sub(hn::Mul(now.xx, now.yy), hn::Mul(now.xy, now.yx));
  const V all = hn::Add(hn::Add(hn::Add(J, hn::Add(x1, y1)), hn::Add(now.xx, now.xy)), hn::Add(now.yx, now.yy));
  const M good = hn::And(r.known, hn::And(hn::Gt(J, l.zero), hn::Lt(hn::Abs(all), hn::Inf(d))));

  hn::StoreInterleaved2(hn::IfThenElse(good, x1, px), hn::IfThenElse(good, y1, py), d, particles.x + 2 * p);
  hn::StoreInterleaved4(hn::IfThenElse(good, now.xx, xx), hn::IfThenElse(good, now.yx, yx),
                        hn::IfThenElse(good, now.xy, xy), hn::IfThenElse(good, now.yy, yy), d, particles.F + 4 * p);
  if (!f.errors.empty())
    step_errors(f, errors_at(f, r.i, r.j, r.xi, r.eta, l.one), s, {xx, xy, yx, yy}, good, l.one, particles, p);
  const V index = hn::Add(hn::Mul(r.j, hn::Set(d, double(f.nx - 1))), r.i);
  const DI32 di;
  hn::StoreU(hn::DemoteTo(di, index), di, particles.element + p);
  HWY_ALIGN double flag[hn::MaxLanes(D())];
  hn::Store(hn::IfThenElseZero(good, l.one), d, flag);
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) particles.moved[p + k] = flag[k] > 0;
}

template <class Reader>
HWY_INLINE void step_all(const FastField& f, const Limits& l, const FastParticles& all, const Reader& read) {
  const std::size_t lanes = hn::Lanes(D());
  std::size_t p = 0;
  for (; p + lanes <= all.count; p += lanes) step_lanes(f, l, all, p, read);
  if (p == all.count) return;
  // The rest, in lanes of its own; those left over are of no particle.
  constexpr std::size_t most = hn::MaxLanes(D());
  double x[2 * most] = {}, F[4 * most] = {}, cov[3 * most] = {}, bias[2 * most] = {}, cov_F[3 * most] = {};
  std::uint8_t status[most] = {}, moved[most];
  std::int32_t element[most];
  const std::size_t rest = all.count - p;
  const auto copy = [&](double* from, std::size_t width, double* to) { std::copy(from, from + width * rest, to); };
  copy(all.x + 2 * p, 2, x), copy(all.F + 4 * p, 4, F), copy(all.cov + 3 * p, 3, cov);
  copy(all.bias + 2 * p, 2, bias), copy(all.cov_F + 3 * p, 3, cov_F);
  std::copy(all.status + p, all.status + all.count, status);
  step_lanes(f, l, {x, F, cov, bias, cov_F, status, lanes, moved, element}, 0, read);
  copy(x, 2, all.x + 2 * p), copy(F, 4, all.F + 4 * p), copy(cov, 3, all.cov + 3 * p);
  copy(bias, 2, all.bias + 2 * p), copy(cov_F, 3, all.cov_F + 3 * p);
  std::copy(moved, moved + rest, all.moved + p);
  std::copy(element, element + rest, all.element + p);
}

}  // namespace pivnp::np::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

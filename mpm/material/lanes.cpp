#include "mpm/material/lanes.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/material/lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "mpm/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Calls body(tile, k) for the batch; `k` is the tile's first point.
template <class Body>
HWY_INLINE void for_batch(const StressBatch& b, Body&& body) {
  std::size_t k = 0;
  for (; k + n_lanes <= b.size; k += n_lanes) body(FullTile{std::uint32_t(k)}, k);
  if (k == b.size) return;
  std::uint32_t rest[n_lanes];
  for (std::size_t l = 0; l < n_lanes; ++l) rest[l] = std::uint32_t(k + l);
  body(PartTile(rest, b.size - k), k);
}

// Appends the lanes of `which` to a list.
HWY_INLINE void list(M which, std::size_t k, std::size_t size, std::uint32_t* rare, std::size_t& n) {
  HWY_ALIGN double in[n_lanes];
  hn::Store(hn::IfThenElseZero(which, set(1)), D(), in);
  for (std::size_t l = 0; l < n_lanes && k + l < size; ++l)
    if (in[l] != 0) rare[n++] = std::uint32_t(k + l);
}

// Stress turned by the step's rotation: mean and half difference in the plane, out of it, shear.
struct Turned {
  V mean, half, zz, xy;
};
template <class Tile>
HWY_INLINE Turned turned(const StressBatch& b, const Tile& t) {
  const V r = set(0.5) * t.load(b.spin), r2 = r * r, scale = set(1) / (set(1) + r2);
  const V c = (set(1) - r2) * scale, s = set(2) * r * scale;
  const V c2 = hn::NegMulAdd(s, s, c * c), s2 = set(2) * c * s;
  const V xx = t.load(b.xx), yy = t.load(b.yy), xy = t.load(b.xy);
  const V half = set(0.5) * (xx - yy);
  return {set(0.5) * (xx + yy), hn::NegMulAdd(s2, xy, c2 * half), t.load(b.zz), hn::MulAdd(s2, half, c2 * xy)};
}

// The first `n` terms; even and odd powers apart, which halves the chain of dependent operations.
template <int n, std::size_t size>
HWY_INLINE V polynomial(V x, const double (&c)[size]) {
  static_assert(n >= 3 && n <= int(size));
  const V x2 = x * x;
  constexpr int even_end = (n - 1) / 2 * 2, odd_end = (n - 2) / 2 * 2 + 1;
  V even = set(c[even_end]), odd = set(c[odd_end]);
  for (int k = even_end - 2; k >= 0; k -= 2) even = hn::MulAdd(even, x2, set(c[k]));
  for (int k = odd_end - 2; k >= 1; k -= 2) odd = hn::MulAdd(odd, x2, set(c[k]));
  return hn::MulAdd(odd, x, even);
}

// With d, e the deviators in the plane of the step and of the elastic strain, exp(d) exp(2e) exp(d) has the deviator
// M = S e + 2 b (a C + b S d.e) d, where a = cosh|d|, b = sinh|d|/|d|, C = cosh 2|e|, S = sinh 2|e|/|e|, and half the
// logarithm's deviator is M arsinh|M|/(2|M|). All are series in squares: no root, no quotient.
constexpr double cosh_series[] = {1, 1.0 / 2, 1.0 / 24, 1.0 / 720, 1.0 / 40320, 1.0 / 3628800, 1.0 / 479001600};
constexpr double sinh_series[] = {1,          1.0 / 6,       1.0 / 120,       1.0 / 5040,
                                  1.0 / 362880, 1.0 / 39916800, 1.0 / 6227020800};
constexpr double arsinh_series[] = {1,
                                    -1.0 / 6,
                                    3.0 / 40,
                                    -5.0 / 112,
                                    35.0 / 1152,
                                    -63.0 / 2816,
                                    231.0 / 13312,
                                    -143.0 / 10240,
                                    6435.0 / 557056,
                                    -12155.0 / 1245184,
                                    46189.0 / 5505024,
                                    -88179.0 / 12058624,
                                    676039.0 / 104857600,
                                    -1300075.0 / 226492416};
constexpr double most_step2 = 1e-4, few_terms = 1e-3, most_terms = 0.06;  // |d|^2; (2|e|)^2 and |M|^2

// M over the elastic strain and over the step's, its square, and shear arsinh|M|/|M|.
struct Combined {
  V mh, mx, m2, factor;
};
template <int hyperbolic, int arsinh>
HWY_INLINE Combined combined(V dh, V dx, V eh, V ex, V d2, V R2, V shear) {
  const V a = polynomial<4>(d2, cosh_series), b = polynomial<4>(d2, sinh_series);
  const V C = polynomial<hyperbolic>(R2, cosh_series), S = set(2) * polynomial<hyperbolic>(R2, sinh_series);
  const V along = set(2) * b * hn::MulAdd(a, C, b * S * hn::MulAdd(dh, eh, dx * ex));
  const V mh = hn::MulAdd(S, eh, along * dh), mx = hn::MulAdd(S, ex, along * dx);
  const V m2 = hn::MulAdd(mh, mh, mx * mx);
  return {mh, mx, m2, shear * polynomial<arsinh>(m2, arsinh_series)};
}

std::size_t hencky(const Elastic& law, const StressBatch& b, std::uint32_t* rare) {
  std::size_t n = 0;
  for_batch(b, [&](const auto& t, std::size_t k) HWY_ATTR {
    const D d;
    const Turned s = turned(b, t);
    const V dxx = t.load(b.de_xx), dyy = t.load(b.de_yy), dzz = t.load(b.de_zz);
    const V shear = set(law.shear), volumetric = set(law.lambda) * (dxx + dyy + dzz);
    const V dh = set(0.5) * (dxx - dyy), dx = t.load(b.de_xy);
    const V eh = s.half * set(0.5 / law.shear), ex = s.xy * set(0.5 / law.shear);
    const V d2 = hn::MulAdd(dh, dh, dx * dx), R2 = set(4) * hn::MulAdd(eh, eh, ex * ex);
    const bool few = hn::AllTrue(d, hn::Le(R2, set(few_terms)));
    Combined m = few ? combined<5, 6>(dh, dx, eh, ex, d2, R2, shear) : combined<7, 14>(dh, dx, eh, ex, d2, R2, shear);
    if (HWY_UNLIKELY(few && !hn::AllTrue(d, hn::Le(m.m2, set(few_terms))))) m = combined<7, 14>(dh, dx, eh, ex, d2, R2, shear);
    V mean = hn::MulAdd(shear, dxx + dyy, s.mean + volumetric), half = m.factor * m.mh, xy = m.factor * m.mx;
    V xx = mean + half, yy = mean - half, zz = hn::MulAdd(shear + shear, dzz, s.zz + volumetric);
    const M common = hn::And(hn::Le(d2, set(most_step2)), hn::Le(hn::Max(R2, m.m2), set(most_terms)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, common))) {
      list(hn::Not(common), k, b.size, rare, n);
      xx = hn::IfThenElse(common, xx, t.load(b.xx));
      yy = hn::IfThenElse(common, yy, t.load(b.yy));
      zz = hn::IfThenElse(common, zz, t.load(b.zz));
      xy = hn::IfThenElse(common, xy, t.load(b.xy));
    }
    t.store(xx, b.xx);
    t.store(yy, b.yy);
    t.store(zz, b.zz);
    t.store(xy, b.xy);
  });
  return n;
}

struct Principal {
  V s[3];
};

// The cone of each lane; the elastic stiffness times the flow of a plane holds three numbers, by the place of the
// largest, the untouched and the smallest stress of the plane.
struct LaneCone {
  V sin, plus, minus;            // sin phi, 1 + sin phi, 1 - sin phi
  V cohesion, tension;           // 2 c cos phi; at J = 1
  bool opens;                    // may a point carry tension until it opens?
  V high, middle, low, per_hardness;  // stiffness times flow; 1 / (normal . that)

  HWY_INLINE LaneCone(V sin_friction, V cohesion_term, double most_tension)
      : sin(sin_friction),
        plus(set(1) + sin_friction),
        minus(set(1) - sin_friction),
        cohesion(cohesion_term),
        tension(set(most_tension)),
        opens(most_tension > 0) {}
  HWY_INLINE void set_flow(V sin_dilatancy, const Elastic& law) {
    const V one = set(1), two_shear = set(2 * law.shear);
    middle = set(2 * law.lambda) * sin_dilatancy;
    high = hn::MulAdd(two_shear, one + sin_dilatancy, middle);
    low = hn::NegMulAdd(two_shear, one - sin_dilatancy, middle);
    per_hardness = one / hn::MulSub(plus, high, minus * low);
  }
  /// Is the cut-off below the apex?
  HWY_INLINE M cut_off() const { return hn::Lt(tension * sin, set(0.5) * cohesion); }
  HWY_INLINE V apex() const {
    return hn::IfThenElse(hn::Gt(sin, zero()), set(0.5) * cohesion / sin, hn::Inf(D()));
  }
};

// One cone for all points.
struct FixedCone {
  LaneCone cone;

  HWY_INLINE FixedCone(const Elastic& law, const ConeConstants& c)
      : cone(set(c.sin_friction), set(c.cohesion_term), c.tension) {
    cone.set_flow(set(c.sin_dilatancy), law);
  }
  static HWY_INLINE bool surely_elastic(V, V, V) { return false; }
  template <class Tile>
  HWY_INLINE LaneCone of(const Tile&) const {
    return cone;
  }
  template <class Tile>
  HWY_INLINE void set_flow(LaneCone&, const Tile&) const {}
};

// StrengthLaw::at() of every point.
struct ChangingCone {
  const Elastic& law;
  const StrengthConstants& s;
  double tension;
  const StressBatch& b;
  const double* history;
  // No strength is below this one where the greatest and the least stress are compressive together.
  double least_sin = std::sin(s.residual_friction);
  double least_cohesion = 2 * s.residual_cohesion * std::cos(std::max(s.friction, s.friction_low));

  HWY_INLINE bool surely_elastic(V greatest, V least, V J) const {
    const V against = hn::MulAdd(set(1 - least_sin), least, set(least_cohesion) * J);
    const V excess = hn::MulSub(set(1 + least_sin), greatest, against);
    return hn::AllTrue(D(), hn::And(hn::And(hn::Le(excess, zero()), hn::Le(greatest + least, zero())),
                                    hn::Le(greatest, set(tension) * J)));
  }
  template <class Tile>
  HWY_INLINE V friction(const Tile& t, V left) const {
    V peak = set(s.friction);
    if (s.per_half > 0) {
      const V pressure = (t.load(b.xx) + t.load(b.yy) + t.load(b.zz)) / (set(-3) * t.load(b.J));
      peak = peak + set(s.friction_low - s.friction) /
                        hn::MulAdd(hn::Max(zero(), pressure), set(s.per_half), set(1));
    }
    return hn::MulAdd(peak - set(s.residual_friction), left, set(s.residual_friction));
  }
  template <class Tile>
  HWY_INLINE V left(const Tile& t) const {
    return s.rate > 0 ? hn::Exp(D(), set(-s.rate) * t.load(history)) : set(1);
  }
  template <class Tile>
  HWY_INLINE LaneCone of(const Tile& t) const {
    const V still = left(t), sin = hn::Sin(D(), friction(t, still));
    V cohesion = zero();
    if (s.cohesion > 0)
      cohesion = hn::MulAdd(set(2 * (s.cohesion - s.residual_cohesion)), still, set(2 * s.residual_cohesion)) *
                 hn::Sqrt((set(1) - sin) * (set(1) + sin));
    return LaneCone(sin, cohesion, tension);
  }
  template <class Tile>
  HWY_INLINE void set_flow(LaneCone& cone, const Tile& t) const {
    V sin_dilatancy = zero();
    if (s.dilatancy > 0) {
      const V fade = s.per_fade > 0 ? hn::Exp(D(), set(-s.per_fade) * t.load(history)) : set(1);
      sin_dilatancy = hn::Sin(D(), hn::Min(friction(t, left(t)), set(s.dilatancy) * fade));
    }
    cone.set_flow(sin_dilatancy, law);
  }
};

template <class Cones>
struct Returning {
  const Elastic& law;
  const Cones& cones;
  const StressBatch& b;
  std::uint32_t* rare;
  std::size_t n = 0;

  static HWY_INLINE Principal less(const Principal& p, V amount, V flow0, V flow1, V flow2) {
    return {{hn::NegMulAdd(amount, flow0, p.s[0]), hn::NegMulAdd(amount, flow1, p.s[1]),
             hn::NegMulAdd(amount, flow2, p.s[2])}};
  }
  static HWY_INLINE Principal choose(M m, const Principal& yes, const Principal& no) {
    return {{hn::IfThenElse(m, yes.s[0], no.s[0]), hn::IfThenElse(m, yes.s[1], no.s[1]),
             hn::IfThenElse(m, yes.s[2], no.s[2])}};
  }

  // The return of sorted trial stresses to the plane or an edge; `found`: where it is admissible.
  static HWY_INLINE Principal back(const LaneCone& c, const Principal& p, V excess, V cohesion, V apex, V round_off,
                                   M& found) {
    const D d;
    const Principal plane = less(p, excess * c.per_hardness, c.high, c.middle, c.low);
    const V top = apex + round_off;
    found = hn::And(hn::And(hn::Ge(plane.s[0] + round_off, plane.s[1]), hn::Ge(plane.s[1] + round_off, plane.s[2])),
                    hn::Le(plane.s[0], top));
    if (hn::AllTrue(d, found)) return plane;
    Principal out = plane;
    const V one = set(1), hardness = one / c.per_hardness;
    const M low = hn::Lt(plane.s[1], plane.s[2]);  // the middle stress has caught up with the smallest
    for (int e = 0; e < 2; ++e) {
      // The inverse of the edge's system: `own` on its diagonal, `across` beside it.
      const V shared = e == 0 ? hn::MulSub(c.plus, c.high, c.minus * c.middle)
                              : hn::MulSub(c.plus, c.middle, c.minus * c.low);
      const V per = one / ((hardness - shared) * (hardness + shared));
      const V own = hardness * per, across = hn::Neg(shared) * per;
      const V high_s = e == 0 ? p.s[0] : p.s[1], low_s = e == 0 ? p.s[1] : p.s[2];
      const V second = hn::MulSub(c.plus, high_s, hn::MulAdd(c.minus, low_s, cohesion));
      const V first_amount = hn::MulAdd(own, excess, across * second);
      const V second_amount = hn::MulAdd(across, excess, own * second);
      const Principal first = less(p, first_amount, c.high, c.middle, c.low);
      const Principal s = e == 0 ? less(first, second_amount, c.high, c.low, c.middle)
                                 : less(first, second_amount, c.middle, c.high, c.low);
      const M sorted = hn::And(hn::Ge(s.s[0] + round_off, hn::Max(s.s[1], s.s[2])),
                               hn::Le(s.s[2], hn::Min(s.s[0], s.s[1]) + round_off));
      const M good = hn::And(hn::And(hn::And(hn::Ge(first_amount, zero()), hn::Ge(second_amount, zero())), sorted),
                             hn::Le(s.s[0], top));
      const M here = hn::AndNot(found, hn::And(good, e == 0 ? low : hn::Not(low)));
      out = choose(here, s, out);
      found = hn::Or(found, here);
    }
    return out;
  }

  template <class Tile>
  HWY_INLINE void tile(const Tile& t, std::size_t k) {
    const D d;
    const Turned turn = turned(b, t);
    const V dxx = t.load(b.de_xx), dyy = t.load(b.de_yy), dzz = t.load(b.de_zz);
    const V two_shear = set(2 * law.shear), volumetric = set(law.lambda) * (dxx + dyy + dzz);
    const V mean = hn::MulAdd(set(law.shear), dxx + dyy, turn.mean + volumetric);
    const V half = hn::MulAdd(set(law.shear), dxx - dyy, turn.half);
    const V zz = hn::MulAdd(two_shear, dzz, turn.zz + volumetric), xy = hn::MulAdd(two_shear, t.load(b.de_xy), turn.xy);
    const V radius = hn::Sqrt(hn::MulAdd(half, half, xy * xy)), J = t.load(b.J);
    const V high = mean + radius, low = mean - radius;
    const M across_high = hn::Gt(zz, high), across_low = hn::Lt(zz, low);
    const Principal p{{hn::Max(high, zz), hn::IfThenElse(across_high, high, hn::IfThenElse(across_low, low, zz)),
                       hn::Min(low, zz)}};
    M odd = hn::Ne(t.load(b.gap), zero());
    if (hn::AllFalse(d, odd) && cones.surely_elastic(p.s[0], p.s[2], J)) {
      t.store(mean + half, b.xx);
      t.store(mean - half, b.yy);
      t.store(zz, b.zz);
      t.store(xy, b.xy);
      return;
    }
    LaneCone c = cones.of(t);
    const V cohesion = c.cohesion * J;
    const V excess = hn::MulSub(c.plus, p.s[0], hn::MulAdd(c.minus, p.s[2], cohesion));
    M yields = hn::Gt(excess, zero());
    const V tension = c.tension * J;
    const M cut_off = c.cut_off();
    odd = hn::Or(odd, hn::AndNot(yields, hn::And(cut_off, hn::Gt(p.s[0], tension))));
    if (c.opens) odd = hn::Or(odd, opened(k));
    V new_mean = mean, new_half = half, new_zz = zz, new_xy = xy;
    yields = hn::AndNot(odd, yields);
    if (!hn::AllFalse(d, yields)) {
      cones.set_flow(c, t);
      const V apex = c.apex() * J;
      const V size = hn::Abs(p.s[0]) + hn::Abs(p.s[2]), round_off = set(1e-12) * (size + cohesion);
      M found;
      const Principal s = back(c, p, excess, cohesion, apex, round_off, found);
      M accepted = found;
      accepted = hn::AndNot(hn::And(cut_off, hn::Gt(s.s[0], tension)), accepted);
      const Principal drop{{p.s[0] - s.s[0], p.s[1] - s.s[1], p.s[2] - s.s[2]}};
      const V trace = drop.s[0] + drop.s[1] + drop.s[2];
      // Plastic strain: C^-1 drop, whose deviator is that of the drop over 2 G.
      const V own = set((1 + law.poisson) / law.young), shared = trace * set(law.poisson / law.young);
      V work = zero(), square = zero();
      for (int q = 0; q < 3; ++q) {
        work = hn::MulAdd(s.s[q], hn::MulSub(own, drop.s[q], shared), work);
        const V deviator = hn::NegMulAdd(trace, set(1.0 / 3), drop.s[q]);
        square = hn::MulAdd(deviator, deviator, square);
      }
      const V across = hn::IfThenElse(across_high, s.s[0], hn::IfThenElse(across_low, s.s[2], s.s[1]));
      const V in_high = hn::IfThenElse(across_high, s.s[1], s.s[0]), in_low = hn::IfThenElse(across_low, s.s[1], s.s[2]);
      // Near the apex under expansion the point may come apart.
      const M parting = hn::And(hn::Gt(trace, zero()), hn::Ge(in_low, hn::NegMulAdd(set(1e-9), size, apex)));
      accepted = hn::AndNot(parting, accepted);
      odd = hn::Or(odd, hn::AndNot(accepted, yields));
      yields = hn::And(yields, accepted);
      const V new_radius = set(0.5) * (in_high - in_low);
      const V ratio = hn::IfThenElseZero(hn::Gt(radius, zero()), new_radius / radius);
      new_mean = hn::IfThenElse(yields, set(0.5) * (in_high + in_low), mean);
      new_half = hn::IfThenElse(yields, hn::IfThenElse(hn::Gt(radius, zero()), half * ratio, new_radius), half);
      new_xy = hn::IfThenElse(yields, xy * ratio, xy);
      new_zz = hn::IfThenElse(yields, across, zz);
      t.store(t.load(b.dissipated) + hn::IfThenElseZero(yields, work), b.dissipated);
      const V amount = set(0.5 / law.shear) * hn::Sqrt(set(2.0 / 3) * square);
      t.store(t.load(b.plastic_dev) + hn::IfThenElseZero(yields, amount), b.plastic_dev);
    }
    V xx = new_mean + new_half, yy = new_mean - new_half;
    if (HWY_UNLIKELY(!hn::AllFalse(d, odd))) {
      list(odd, k, b.size, rare, n);
      xx = hn::IfThenElse(odd, t.load(b.xx), xx);
      yy = hn::IfThenElse(odd, t.load(b.yy), yy);
      new_zz = hn::IfThenElse(odd, t.load(b.zz), new_zz);
      new_xy = hn::IfThenElse(odd, t.load(b.xy), new_xy);
    }
    t.store(xx, b.xx);
    t.store(yy, b.yy);
    t.store(new_zz, b.zz);
    t.store(new_xy, b.xy);
  }

  // Points that have opened once carry no tension any more.
  HWY_INLINE M opened(std::size_t k) const {
    HWY_ALIGN double flag[n_lanes] = {};
    for (std::size_t l = 0; l < n_lanes && k + l < b.size; ++l) flag[l] = b.opened[k + l];
    return hn::Ne(hn::Load(D(), flag), zero());
  }
};

template <class Cones>
HWY_INLINE std::size_t return_all(const Elastic& law, const Cones& cones, const StressBatch& b, std::uint32_t* rare) {
  Returning<Cones> update{law, cones, b, rare};
  for_batch(b, [&](const auto& t, std::size_t k) HWY_ATTR { update.tile(t, k); });
  return update.n;
}

std::size_t cone(const Elastic& law, const ConeConstants& c, const StressBatch& b, std::uint32_t* rare) {
  return return_all(law, FixedCone(law, c), b, rare);
}

std::size_t changing_cone(const Elastic& law, const StrengthConstants& s, double tension, const double* history,
                          const StressBatch& b, std::uint32_t* rare) {
  return return_all(law, ChangingCone{law, s, tension, b, history}, b, rare);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(hencky);
HWY_EXPORT(cone);
HWY_EXPORT(changing_cone);

std::size_t hencky_lanes(const Elastic& elastic, const StressBatch& batch, std::uint32_t* rare) {
  return HWY_DYNAMIC_DISPATCH(hencky)(elastic, batch, rare);
}
std::size_t cone_lanes(const Elastic& elastic, const ConeConstants& c, const StressBatch& batch,
                       std::uint32_t* rare) {
  return HWY_DYNAMIC_DISPATCH(cone)(elastic, c, batch, rare);
}
std::size_t changing_cone_lanes(const Elastic& elastic, const StrengthConstants& strength, double tension,
                                const double* history, const StressBatch& batch, std::uint32_t* rare) {
  return HWY_DYNAMIC_DISPATCH(changing_cone)(elastic, strength, tension, history, batch, rare);
}

}  // namespace pivnp::mpm
#endif

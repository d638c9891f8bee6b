// Mohr-Coulomb in lanes.
#include "mpm/material/lanes.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/material/cone_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "mpm/material/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

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
  HWY_INLINE void set_flow(V sin_dilatancy, const LaneElastic& law) {
    const V one = set(1);
    middle = law.two_lambda * sin_dilatancy;
    high = hn::MulAdd(law.two_shear, one + sin_dilatancy, middle);
    low = hn::NegMulAdd(law.two_shear, one - sin_dilatancy, middle);
    per_hardness = one / hn::MulSub(plus, high, minus * low);
  }
  /// Is the cut-off below the apex?
  HWY_INLINE M cut_off() const { return hn::Lt(tension * sin, set(0.5) * cohesion); }
  HWY_INLINE V apex() const {
    return hn::IfThenElse(hn::Gt(sin, zero()), set(0.5) * cohesion / sin, hn::Inf(D()));
  }
};

// What a cone is made of, lane by lane.
struct Strengths {
  V sin, cohesion, sin_dilatancy;  // sin phi, 2 c cos phi at J = 1, sin psi
};

// One cone for all points.
struct FixedCone {
  LaneCone cone;

  HWY_INLINE FixedCone(const LaneElastic& law, const ConeConstants& c)
      : cone(set(c.sin_friction), set(c.cohesion_term), c.tension) {
    cone.set_flow(set(c.sin_dilatancy), law);
  }
  HWY_INLINE bool surely_elastic(V greatest, V least, V J) const {
    const V excess = hn::MulSub(cone.plus, greatest, hn::MulAdd(cone.minus, least, cone.cohesion * J));
    return hn::AllTrue(D(), hn::And(hn::Le(excess, zero()), hn::Le(greatest, zero())));
  }
  template <class Tile>
  HWY_INLINE Strengths strengths(const Tile&) const {
    return {zero(), zero(), zero()};
  }
  HWY_INLINE LaneCone of(const Strengths&) const { return cone; }
  HWY_INLINE void set_flow(LaneCone&, const Strengths&) const {}
};

// StrengthLaw::at() of every point.
struct ChangingCone {
  const LaneElastic law;
  const StrengthConstants s;
  double tension;
  const StressBatch b;
  const double* history;
  // No strength is below this one where the greatest and the least stress are compressive together.
  double least_sin = std::sin(s.residual_friction);
  double least_cohesion = 2 * s.residual_cohesion * std::cos(std::max(s.friction, s.friction_low));

  HWY_INLINE bool surely_elastic(V greatest, V least, V J) const {
    const V against = hn::MulAdd(set(1 - least_sin), least, set(least_cohesion) * J);
    const V excess = hn::MulSub(set(1 + least_sin), greatest, against);
    return hn::AllTrue(D(), hn::And(hn::Le(excess, zero()), hn::Le(greatest, zero())));
  }
  template <class Tile>
  HWY_INLINE Strengths strengths(const Tile& t) const {
    const V strain = t.load(history), left = s.rate > 0 ? hn::Exp(D(), set(-s.rate) * strain) : set(1);
    V peak = set(s.friction);
    if (s.per_half > 0) {
      const V pressure = (t.load(b.xx) + t.load(b.yy) + t.load(b.zz)) / (set(-3) * t.load(b.J));
      peak = peak + set(s.friction_low - s.friction) /
                        hn::MulAdd(hn::Max(zero(), pressure), set(s.per_half), set(1));
    }
    const V friction = hn::MulAdd(peak - set(s.residual_friction), left, set(s.residual_friction));
    const V sin = sine(friction);
    V cohesion = zero(), sin_dilatancy = zero();
    if (s.cohesion > 0)
      cohesion = hn::MulAdd(set(2 * (s.cohesion - s.residual_cohesion)), left, set(2 * s.residual_cohesion)) *
                 hn::Sqrt((set(1) - sin) * (set(1) + sin));
    if (s.dilatancy > 0) {
      const V fade = s.per_fade > 0 ? hn::Exp(D(), set(-s.per_fade) * strain) : set(1);
      sin_dilatancy = sine(hn::Min(friction, set(s.dilatancy) * fade));
    }
    return {sin, cohesion, sin_dilatancy};
  }
  HWY_INLINE LaneCone of(const Strengths& at) const { return LaneCone(at.sin, at.cohesion, tension); }
  HWY_INLINE void set_flow(LaneCone& cone, const Strengths& at) const { cone.set_flow(at.sin_dilatancy, law); }
};

// A tile whose trial stress may lie beyond the cone.
struct Waiting {
  V mean, half, zz, xy;  // trial stress
  Strengths strengths;
  std::size_t k;
};

template <class Cones>
struct Returning {
  const Elastic law;
  const LaneElastic elastic;
  const Cones cones;
  const StressBatch b;
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

  // Sorted principal stresses.
  struct Sorted {
    V radius;
    M across_high, across_low;  // is the stress across the plane the greatest, the least?
    Principal p;
  };
  static HWY_INLINE Sorted sorted(V mean, V half, V zz, V xy) {
    const V radius = hn::Sqrt(hn::MulAdd(half, half, xy * xy)), high = mean + radius, low = mean - radius;
    const M across_high = hn::Gt(zz, high), across_low = hn::Lt(zz, low);
    const V middle = hn::IfThenElse(across_high, high, hn::IfThenElse(across_low, low, zz));
    return {radius, across_high, across_low, {{hn::Max(high, zz), middle, hn::Min(low, zz)}}};
  }

  // The trial stress; elastic tiles are done with it. True if `w` has to be returned.
  template <class Tile, class Step>
  HWY_INLINE bool trial(const Tile& t, const Step& step, Waiting& w) const {
    const Turned turn = turned(b, t, step);
    const V dxx = step.load(b.de_xx), dyy = step.load(b.de_yy), dzz = step.load(b.de_zz);
    const V volumetric = elastic.lambda * (dxx + dyy + dzz);
    w.mean = hn::MulAdd(elastic.shear, dxx + dyy, turn.mean + volumetric);
    w.half = hn::MulAdd(elastic.shear, dxx - dyy, turn.half);
    w.zz = hn::MulAdd(elastic.two_shear, dzz, turn.zz + volumetric);
    w.xy = hn::MulAdd(elastic.two_shear, step.load(b.de_xy), turn.xy);
    const Sorted at = sorted(w.mean, w.half, w.zz, w.xy);
    if (!hn::AllTrue(D(), hn::Eq(t.load(b.history[plastic::opening]), zero())) || !cones.surely_elastic(at.p.s[0], at.p.s[2], t.load(b.J)))
      return true;
    t.store(w.mean + w.half, b.xx);
    t.store(w.mean - w.half, b.yy);
    t.store(w.zz, b.zz);
    t.store(w.xy, b.xy);
    return false;
  }

  // Open points that do not close in the step (`apart`) are free of stress.
  template <class Tile, class Step>
  HWY_INLINE M stay_open(const Tile& t, const Step& step) const {
    const V opening = t.load(b.history[plastic::opening]), left = opening + (step.load(b.de_xx) + step.load(b.de_yy) + step.load(b.de_zz));
    const M apart = hn::And(hn::Gt(opening, zero()), hn::Gt(left, zero()));
    const V xx = t.load(b.xx), yy = t.load(b.yy), zz = t.load(b.zz), xy = t.load(b.xy), sum = xx + yy + zz;
    const V squares = hn::MulAdd(xx, xx, yy * yy) + hn::MulAdd(zz, zz, set(2) * xy * xy);
    const V energy = set(0.5 / law.young) * hn::NegMulAdd(set(law.poisson) * sum, sum, set(1 + law.poisson) * squares);
    t.store(t.load(b.history[plastic::work]) + hn::IfThenElseZero(apart, energy), b.history[plastic::work]);
    t.store(hn::IfThenElse(apart, left, opening), b.history[plastic::opening]);
    return apart;
  }

  template <class Tile, class Step>
  HWY_INLINE void tile(const Tile& t, const Step& step, const Waiting& w) {
    const D d;
    const std::size_t k = w.k;
    const V mean = w.mean, half = w.half, zz = w.zz, xy = w.xy, J = t.load(b.J);
    const Sorted at = sorted(mean, half, zz, xy);
    const V radius = at.radius;
    const M across_high = at.across_high, across_low = at.across_low;
    const Principal& p = at.p;
    M odd = hn::Ne(t.load(b.history[plastic::opening]), zero()), apart = hn::FirstN(d, 0);
    if (HWY_UNLIKELY(!hn::AllFalse(d, odd))) apart = stay_open(t, step);
    LaneCone c = cones.of(w.strengths);
    const V cohesion = c.cohesion * J;
    const V excess = hn::MulSub(c.plus, p.s[0], hn::MulAdd(c.minus, p.s[2], cohesion));
    M yields = hn::Gt(excess, zero());
    const V tension = c.tension * J;
    const M cut_off = c.cut_off();
    odd = hn::Or(odd, hn::AndNot(yields, hn::And(cut_off, hn::Gt(p.s[0], tension))));
    if (c.opens) odd = hn::Or(odd, has_separated(b, k));
    V new_mean = hn::IfThenZeroElse(apart, mean), new_half = hn::IfThenZeroElse(apart, half);
    V new_zz = hn::IfThenZeroElse(apart, zz), new_xy = hn::IfThenZeroElse(apart, xy);
    odd = hn::AndNot(apart, odd);
    yields = hn::AndNot(hn::Or(odd, apart), yields);
    if (!hn::AllFalse(d, yields)) {
      cones.set_flow(c, w.strengths);
      const V apex = c.apex() * J;
      const V size = hn::Abs(p.s[0]) + hn::Abs(p.s[2]), round_off = set(1e-12) * (size + cohesion);
      M found;
      const Principal s = back(c, p, excess, cohesion, apex, round_off, found);
      M accepted = found;
      accepted = hn::AndNot(hn::And(cut_off, hn::Gt(s.s[0], tension)), accepted);
      const Principal drop{{p.s[0] - s.s[0], p.s[1] - s.s[1], p.s[2] - s.s[2]}};
      const V trace = drop.s[0] + drop.s[1] + drop.s[2];
      // Plastic strain: C^-1 drop, whose deviator is that of the drop over 2 G.
      const V shared = trace * elastic.shared;
      V work = zero(), square = zero();
      for (int q = 0; q < 3; ++q) {
        work = hn::MulAdd(s.s[q], hn::MulSub(elastic.own, drop.s[q], shared), work);
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
      new_mean = hn::IfThenElse(yields, set(0.5) * (in_high + in_low), new_mean);
      new_half = hn::IfThenElse(yields, hn::IfThenElse(hn::Gt(radius, zero()), half * ratio, new_radius), new_half);
      new_xy = hn::IfThenElse(yields, xy * ratio, new_xy);
      new_zz = hn::IfThenElse(yields, across, new_zz);
      t.store(t.load(b.history[plastic::work]) + hn::IfThenElseZero(yields, work), b.history[plastic::work]);
      const V amount = elastic.per_two_shear * hn::Sqrt(set(2.0 / 3) * square);
      t.store(t.load(b.history[plastic::strain]) + hn::IfThenElseZero(yields, amount), b.history[plastic::strain]);
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
};

// In three passes, of which each has a short chain of operations that wait for each other: so those of several tiles
// overlap.
template <class Cones>
HWY_INLINE std::size_t return_all(const Elastic& law, const Cones& cones, const StressBatch& b, std::uint32_t* rare) {
  Returning<Cones> update{law, LaneElastic(law), cones, b, rare};
  Waiting waiting[most_in_lanes / n_lanes];
  std::size_t n = 0;
  for_batch(b, [&](const auto& t, const auto& step, std::size_t k) PIVNP_TILE {
    waiting[n].k = k;
    n += update.trial(t, step, waiting[n]);
  });
  for (std::size_t a = 0; a < n; ++a)
    with_tile(b, waiting[a].k, [&](const auto& t, const auto&) PIVNP_TILE { waiting[a].strengths = cones.strengths(t); });
  for (std::size_t a = 0; a < n; ++a)
    with_tile(b, waiting[a].k, [&](const auto& t, const auto& step) PIVNP_TILE { update.tile(t, step, waiting[a]); });
  return update.n;
}

std::size_t cone(const Elastic& law, const ConeConstants& c, const StressBatch& b, std::uint32_t* rare) {
  return return_all(law, FixedCone(LaneElastic(law), c), b, rare);
}

std::size_t changing_cone(const Elastic& law, const StrengthConstants& s, double tension, const double* history,
                          const StressBatch& b, std::uint32_t* rare) {
  return return_all(law, ChangingCone{LaneElastic(law), s, tension, b, history}, b, rare);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(cone);
HWY_EXPORT(changing_cone);

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

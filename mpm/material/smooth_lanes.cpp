// The smooth Mohr-Coulomb law in lanes: the algorithm is smooth_mohr_coulomb.cpp's, for points that yield all along the
// step or not at all. The formulas of the surface are abbo_sloan.hpp's, those of the strength strength.cpp's.
#include "mpm/material/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/material/smooth_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "mpm/material/batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

struct LaneTensor {
  V xx, yy, zz, xy;
};
HWY_INLINE LaneTensor plus(const LaneTensor& a, const LaneTensor& b, V factor) {
  return {hn::MulAdd(factor, b.xx, a.xx), hn::MulAdd(factor, b.yy, a.yy), hn::MulAdd(factor, b.zz, a.zz),
          hn::MulAdd(factor, b.xy, a.xy)};
}
HWY_INLINE LaneTensor choose(M m, const LaneTensor& yes, const LaneTensor& no) {
  return {hn::IfThenElse(m, yes.xx, no.xx), hn::IfThenElse(m, yes.yy, no.yy), hn::IfThenElse(m, yes.zz, no.zz),
          hn::IfThenElse(m, yes.xy, no.xy)};
}
HWY_INLINE V product(const LaneTensor& a, const LaneTensor& b) {
  return hn::MulAdd(a.xx, b.xx, a.yy * b.yy) + hn::MulAdd(a.zz, b.zz, (a.xy + a.xy) * b.xy);
}
HWY_INLINE V trace(const LaneTensor& a) { return a.xx + a.yy + a.zz; }
HWY_INLINE LaneTensor deviator_of(const LaneTensor& a) {
  const V mean = trace(a) * set(1.0 / 3);
  return {a.xx - mean, a.yy - mean, a.zz - mean, a.xy};
}

struct LaneStrength {
  V sin, cos, cohesion, sin_dilatancy;
  V friction_by_history, friction_by_pressure, cohesion_by_history;
};

// A stress and its surface.
struct LanePlace {
  LaneTensor stress, deviator;
  V history, mean, bar, sin3;
  V a, b, a3, b3;  // K = a + b sin phi, dK/d theta over cos 3 theta = a3 + b3 sin phi
  LaneStrength strength;
  V intercept, reach, root, F;
  V size, tolerance, most_mean;

  HWY_INLINE M outside() const { return hn::Gt(F, tolerance); }
  HWY_INLINE M at_limit() const { return hn::Ge(mean, most_mean - tolerance); }
};
struct LaneRate {
  LaneTensor stress;
  V history;
};

template <bool constant>
struct Smooth {
  const Elastic law;
  const SmoothConstants s;
  const StressBatch b;
  V J;                       // of the tile
  V given = zero();          // the strain that softens, where it is given from outside
  bool is_given = b.softened_by != nullptr;

  HWY_INLINE LaneStrength strength(V history, V mean) const {
    const StrengthConstants& c = s.strength;
    if constexpr (constant)
      return {set(s.sin_friction), set(s.cos_friction), set(c.cohesion), set(s.sin_dilatancy), zero(), zero(), zero()};
    const V strain = is_given ? given : history, left = c.rate > 0 ? hn::Exp(D(), set(-c.rate) * strain) : set(1);
    V peak = set(c.friction), by_pressure = zero();
    if (c.per_half > 0) {
      const V pressure = hn::Neg(mean) / J, per = set(1) / hn::MulAdd(hn::Max(zero(), pressure), set(c.per_half), set(1));
      const double gain = c.friction_low - c.friction;
      peak = hn::MulAdd(set(gain), per, peak);
      by_pressure = hn::IfThenElseZero(hn::Gt(pressure, zero()), set(-gain * c.per_half) * per * per * left);
    }
    const V above = (peak - set(c.residual_friction)) * left, friction = set(c.residual_friction) + above;
    const V lost = set(c.cohesion - c.residual_cohesion) * left, sin = sine(friction);
    V sin_dilatancy = hn::Min(sin, set(s.sin_dilatancy));
    if (c.per_fade > 0)
      sin_dilatancy = sine(hn::Min(friction, set(c.dilatancy) * hn::Exp(D(), set(-c.per_fade) * strain)));
    const V rate = set(is_given ? 0 : -c.rate);
    return {sin,           hn::Sqrt((set(1) - sin) * (set(1) + sin)), set(c.residual_cohesion) + lost,
            sin_dilatancy, rate * above,                              by_pressure,
            rate * lost};
  }

  HWY_INLINE void set_section(LanePlace& p, V sine_angle) const {
    const D d;
    const V cosine = hn::Sqrt(hn::NegMulAdd(sine_angle, sine_angle, set(1)));
    const V per = set(1) / (cosine * hn::NegMulAdd(set(4) * sine_angle, sine_angle, set(1)));  // 1 / cos 3 theta
    const double per_root3 = 1 / root3;
    p.a = cosine;
    p.b = set(-per_root3) * sine_angle;
    p.a3 = hn::Neg(sine_angle) * per;
    p.b3 = set(-per_root3) * cosine * per;
    const M rounded = hn::Gt(hn::Abs(p.sin3), set(s.sin3_transition));
    if (hn::AllFalse(d, rounded)) return;
    const M high = hn::Gt(p.sin3, zero());
    for (int part = 0; part < 2; ++part) {
      const auto of = [&](const double (&end)[2][2]) HWY_ATTR { return hn::IfThenElse(high, set(end[1][part]), set(end[0][part])); };
      const V A = of(s.a), B = of(s.b), C = of(s.c);
      V &value = part == 0 ? p.a : p.b, &slope = part == 0 ? p.a3 : p.b3;
      value = hn::IfThenElse(rounded, hn::MulAdd(p.sin3, hn::MulAdd(p.sin3, C, B), A), value);
      slope = hn::IfThenElse(rounded, set(3) * hn::MulAdd(C + C, p.sin3, B), slope);
    }
  }

  // Where the history is that of another place, so is the strength (`known`), unless it depends on pressure.
  HWY_INLINE LanePlace place(const LaneTensor& stress, V history, const LaneStrength* known = nullptr) const {
    LanePlace p;
    p.stress = stress;
    p.history = history;
    p.deviator = deviator_of(stress);
    p.mean = trace(stress) * set(1.0 / 3);
    const LaneTensor& e = p.deviator;
    const V half = set(0.5) * (e.xx - e.yy), radius2 = hn::MulAdd(half, half, e.xy * e.xy), radius = hn::Sqrt(radius2);
    p.bar = hn::Sqrt(hn::MulAdd(set(0.75) * e.zz, e.zz, radius2));
    const V low = set(0.5) * e.zz, middle = hn::Max(hn::Min(e.zz, radius - low), hn::Neg(radius) - low);
    V sine_angle = hn::IfThenElseZero(hn::Gt(p.bar, zero()), set(0.5 * root3) * (middle / p.bar));
    sine_angle = hn::Max(set(-0.5), hn::Min(sine_angle, set(0.5)));
    p.sin3 = sine_angle * hn::NegMulAdd(set(4) * sine_angle, sine_angle, set(3));
    set_section(p, sine_angle);
    const LaneStrength& c = p.strength = known && !(s.strength.per_half > 0) ? *known : strength(history, p.mean);
    p.intercept = J * hn::Max(c.cohesion * c.cos, set(s.floor) * c.sin);
    p.reach = p.bar * hn::MulAdd(p.b, c.sin, p.a);
    p.root = hyperbola_root(p.reach, p.intercept);
    p.F = hn::MulAdd(p.mean, c.sin, p.root - p.intercept);
    p.size = hn::Max(hn::Max(c.cohesion * J, hn::Abs(p.mean)), set(1000));
    p.tolerance = set(s.yield_tolerance) * p.size;
    const V vertex = hn::IfThenElse(hn::Gt(c.sin, zero()), set(s.short_of_vertex) * p.intercept / c.sin, hn::Inf(D()));
    p.most_mean = hn::Min(set(s.tension) * J, vertex);
    return p;
  }
  HWY_INLINE V hyperbola_root(V reach, V t) const {
    const V a = set(s.hyperbola) * t;
    return hn::Sqrt(hn::MulAdd(reach, reach, a * a));
  }

  HWY_INLINE LaneTensor deviatoric(const LanePlace& p, V sin_angle, V reach, V root) const {
    const M there = hn::Gt(p.bar, zero());
    const V per_bar = hn::IfThenElseZero(there, set(1) / p.bar), K3 = hn::MulAdd(p.b3, sin_angle, p.a3);
    const V K = reach * per_bar, factor = hn::IfThenElseZero(there, K / root);
    const V straight = set(0.5) * factor * hn::NegMulAdd(K3, p.sin3, K);
    const V bent = set(-0.5 * root3) * factor * K3 * per_bar, third = set(2.0 / 3) * p.bar * p.bar;
    const LaneTensor& e = p.deviator;
    const V xy2 = e.xy * e.xy;
    return {hn::MulAdd(straight, e.xx, bent * (hn::MulAdd(e.xx, e.xx, xy2) - third)),
            hn::MulAdd(straight, e.yy, bent * (hn::MulAdd(e.yy, e.yy, xy2) - third)),
            hn::MulAdd(straight, e.zz, bent * hn::MulSub(e.zz, e.zz, third)),
            e.xy * hn::MulAdd(bent, e.xx + e.yy, straight)};
  }
  HWY_INLINE LaneTensor gradient(const LanePlace& p) const {
    LaneTensor g = deviatoric(p, p.strength.sin, p.reach, p.root);
    V mean = p.strength.sin * set(1.0 / 3);
    if (!constant && s.strength.per_half > 0)
      mean = mean - by_friction(p) * p.strength.friction_by_pressure / (set(3) * J);
    g.xx = g.xx + mean;
    g.yy = g.yy + mean;
    g.zz = g.zz + mean;
    return g;
  }
  HWY_INLINE LaneTensor flow(const LanePlace& p) const {
    const V sin_angle = p.strength.sin_dilatancy, reach = p.bar * hn::MulAdd(p.b, sin_angle, p.a);
    LaneTensor g = deviatoric(p, sin_angle, reach, hyperbola_root(reach, p.intercept));
    const V mean = sin_angle * set(1.0 / 3);
    g.xx = g.xx + mean;
    g.yy = g.yy + mean;
    g.zz = g.zz + mean;
    return g;
  }
  HWY_INLINE M cohesive(const LaneStrength& c) const { return hn::Ge(c.cohesion * c.cos, set(s.floor) * c.sin); }
  HWY_INLINE V by_friction(const LanePlace& p) const {
    const LaneStrength& c = p.strength;
    const V dt = J * hn::IfThenElse(cohesive(c), hn::Neg(c.cohesion) * c.sin, set(s.floor) * c.cos);
    const V K_by_angle = p.b * c.cos, bent = set(s.hyperbola * s.hyperbola) * p.intercept * dt;
    return hn::MulAdd(p.mean, c.cos, hn::MulAdd(p.bar * p.reach, K_by_angle, bent) / p.root - dt);
  }
  HWY_INLINE V by_history(const LanePlace& p) const {
    if (constant || is_given || !(s.strength.rate > 0)) return zero();
    const LaneStrength& c = p.strength;
    const V of_cohesion = J * c.cos * c.cohesion_by_history *
                          hn::MulSub(set(s.hyperbola * s.hyperbola), p.intercept / p.root, set(1));
    return hn::MulAdd(by_friction(p), c.friction_by_history, hn::IfThenElseZero(cohesive(c), of_cohesion));
  }

  HWY_INLINE LaneTensor stiff(const LaneTensor& e) const {
    const V volumetric = set(law.lambda) * trace(e), two_shear = set(2 * law.shear);
    return {hn::MulAdd(two_shear, e.xx, volumetric), hn::MulAdd(two_shear, e.yy, volumetric),
            hn::MulAdd(two_shear, e.zz, volumetric), two_shear * e.xy};
  }
  HWY_INLINE V energy_of(const LaneTensor& t) const {
    const V sum = trace(t), squares = product(t, t);
    return set(0.5 / law.young) * hn::NegMulAdd(set(law.poisson) * sum, sum, set(1 + law.poisson) * squares);
  }

  // The flow at a place, what it takes from F and what it adds to the history.
  struct Flow {
    LaneTensor a, Db;
    V per, hardness, softened;  // softened: no less than a share of the hardness
  };
  HWY_INLINE Flow flow_at(const LanePlace& p) const {
    Flow f;
    f.a = gradient(p);
    const LaneTensor along = flow(p), dev = deviator_of(along);
    f.Db = stiff(along);
    f.per = hn::Sqrt(set(2.0 / 3) * product(dev, dev));
    f.hardness = product(f.a, f.Db);
    f.softened = hn::Max(hn::NegMulAdd(by_history(p), f.per, f.hardness), set(s.least_hardness) * f.hardness);
    return f;
  }
  HWY_INLINE LaneRate yielding(const LanePlace& p, const Flow& f, const LaneTensor& elastic, M flows) const {
    const M on = hn::And(hn::Or(flows, hn::Ge(p.F, set(-10) * p.tolerance)), hn::Gt(f.hardness, zero()));
    const V amount = hn::IfThenElseZero(on, hn::Max(zero(), product(f.a, elastic) / f.softened));
    return {plus(elastic, f.Db, hn::Neg(amount)), amount * f.per};
  }

  // Those of `wanted` back to the surface; those that do not get there by the common way are left to `rare`.
  HWY_INLINE void correct(LanePlace& p, M wanted, M& rare) const {
    const D d;
    constexpr int most = 6;
    for (int n = 0; n <= most; ++n) {
      const M off = hn::And(hn::AndNot(rare, wanted), hn::Or(p.outside(), hn::Gt(p.mean, p.most_mean)));
      if (HWY_LIKELY(hn::AllFalse(d, off))) return;
      rare = hn::Or(rare, hn::And(off, hn::Gt(p.mean, p.most_mean)));
      if (n == most) break;
      const Flow f = flow_at(p);
      const V amount = p.F / f.softened;
      LanePlace moved = place(plus(p.stress, f.Db, hn::Neg(amount)), hn::MulAdd(amount, f.per, p.history));
      // Past the surface: only with softening; or no way to it.
      const M lost = hn::Or(hn::Lt(moved.F, hn::Neg(moved.tolerance)), hn::Not(hn::Lt(moved.F, p.F)));
      rare = hn::Or(rare, hn::And(off, hn::Or(lost, hn::Not(hn::Gt(f.hardness, zero())))));
      p = place(choose(off, moved.stress, p.stress), hn::IfThenElse(off, moved.history, p.history));
    }
    rare = hn::Or(rare, hn::And(wanted, p.outside()));
  }

  // Modified Euler from a place on the surface, each lane with substeps of its own; lanes that leave the surface, reach the
  // greatest mean stress or need too many go to `rare`.
  struct Flowed {
    LaneTensor stress;
    V history, work;
  };
  HWY_INLINE Flowed substeps(LanePlace here, const LaneTensor& de, M yields, M& rare) const {
    const D d;
    constexpr int most = 64;
    const V one = set(1), half = set(0.5);
    const LaneTensor elastic = stiff(de);
    V done = zero(), size = one, work = zero();
    M failed = hn::Ne(one, one);
    for (int n = 0; n < most; ++n) {
      const M active = hn::And(hn::AndNot(rare, yields), hn::Lt(done, one));
      if (hn::AllFalse(d, active)) return {here.stress, here.history, work};
      const LaneTensor part{elastic.xx * size, elastic.yy * size, elastic.zz * size, elastic.xy * size};
      const Flow at = flow_at(here);
      rare = hn::Or(rare, hn::And(active, hn::Or(hn::Lt(here.F, set(-10) * here.tolerance),
                                                 hn::Lt(product(at.a, elastic), zero()))));
      const LaneRate first = yielding(here, at, part, hn::Ne(one, one));
      const LanePlace middle = place(plus(here.stress, first.stress, one), here.history + first.history);
      rare = hn::Or(rare, hn::And(active, middle.at_limit()));
      const LaneRate second = yielding(middle, flow_at(middle), part, hn::Gt(first.history, zero()));
      const LaneTensor stress = plus(plus(here.stress, first.stress, half), second.stress, half);
      const LaneTensor change = plus(second.stress, first.stress, set(-1));
      const V least = hn::Max(hn::Sqrt(product(stress, stress)), set(0.1) * here.size);
      const V error = half * hn::Sqrt(product(change, change)) / least;
      const V share = hn::IfThenElse(hn::Gt(error, zero()), set(0.9) * hn::Sqrt(set(s.stress_tolerance) / error), set(4));
      const M good = hn::And(active, hn::Or(hn::Le(error, set(s.stress_tolerance)), hn::Le(size, set(s.least_substep))));
      const V booked = half * size * (product(here.stress, de) + product(stress, de));
      work = work + hn::IfThenElseZero(good, booked);
      const V history = here.history + half * (first.history + second.history);
      here = place(choose(good, stress, here.stress), hn::IfThenElse(good, history, here.history));
      correct(here, good, rare);
      const V left = one - done - size, grow = hn::Min(set(4), hn::IfThenElse(failed, hn::Min(share, one), share));
      done = hn::IfThenElse(good, hn::IfThenElse(hn::Lt(left, set(1e-12)), one, done + size), done);
      const V next = size * hn::IfThenElse(good, grow, hn::Max(set(0.1), share));
      size = hn::Min(hn::Max(set(s.least_substep), next), one - done);
      failed = hn::AndNot(good, active);
      rare = hn::Or(rare, hn::And(good, hn::And(hn::Lt(done, one), here.at_limit())));
    }
    rare = hn::Or(rare, hn::And(yields, hn::Lt(done, one)));
    return {here.stress, here.history, work};
  }

  // A step of a tile's points: stress, history and dissipation become what they are after it, except for those of `rare`.
  struct State {
    LaneTensor stress;  // turned by the step
    V history, dissipated;
    M rare;
  };
  HWY_NOINLINE State advance(State state, LaneTensor de) const {
    const D d;
    M rare = state.rare;
    LanePlace here = place(state.stress, state.history);
    const V start = energy_of(here.stress);
    correct(here, hn::FirstN(d, n_lanes), rare);  // to this step's J and pressure
    rare = hn::Or(rare, here.at_limit());

    const LaneTensor elastic = stiff(de);
    const M inside = hn::Lt(here.F, set(-10) * here.tolerance);
    const M yields = hn::AndNot(inside, hn::Ge(product(gradient(here), elastic), zero()));
    State end{here.stress, here.history, zero(), rare};
    if (!hn::AllTrue(d, yields)) {
      const LanePlace there = place(plus(here.stress, elastic, set(1)), here.history, &here.strength);
      rare = hn::Or(rare, hn::AndNot(yields, hn::Or(there.outside(), hn::Gt(there.mean, there.most_mean))));
      end.stress = there.stress;
    }
    V work = set(0.5) * (product(here.stress, de) + product(end.stress, de));
    if (!hn::AllFalse(d, hn::AndNot(rare, yields))) {
      const Flowed flowed = substeps(here, de, yields, rare);
      end.stress = choose(yields, flowed.stress, end.stress);
      end.history = hn::IfThenElse(yields, flowed.history, end.history);
      work = hn::IfThenElse(yields, flowed.work, work);
    }
    end.dissipated = state.dissipated + (work - (energy_of(end.stress) - start));
    end.rare = rare;
    return end;
  }

  template <class Tile, class Step>
  HWY_INLINE void tile(const Tile& t, const Step& step, std::size_t k, std::uint32_t* list_of_rare, std::size_t& n) {
    J = t.load(b.J);
    if (is_given) given = t.load(b.softened_by);
    const Turned turn = turned(b, t, step);
    const LaneTensor turned_stress{turn.mean + turn.half, turn.mean - turn.half, turn.zz, turn.xy};
    const V history = t.load(b.plastic_dev), dissipated = t.load(b.dissipated);
    const M not_closed = hn::Or(hn::Ne(t.load(b.gap), zero()), has_opened(b, k));
    const State end = advance({turned_stress, history, dissipated, not_closed},
                              {step.load(b.de_xx), step.load(b.de_yy), step.load(b.de_zz), step.load(b.de_xy)});
    if (HWY_UNLIKELY(!hn::AllFalse(D(), end.rare))) list(end.rare, k, b.size, list_of_rare, n);
    const LaneTensor stress = choose(end.rare, {t.load(b.xx), t.load(b.yy), t.load(b.zz), t.load(b.xy)}, end.stress);
    t.store(stress.xx, b.xx);
    t.store(stress.yy, b.yy);
    t.store(stress.zz, b.zz);
    t.store(stress.xy, b.xy);
    t.store(hn::IfThenElse(end.rare, history, end.history), b.plastic_dev);
    t.store(hn::IfThenElse(end.rare, dissipated, end.dissipated), b.dissipated);
  }

 private:
  static constexpr double root3 = 1.7320508075688772935;
};

template <bool constant>
HWY_INLINE std::size_t advance_all(const Elastic& law, const SmoothConstants& s, const StressBatch& b, std::uint32_t* rare) {
  Smooth<constant> update{law, s, b, zero()};
  std::size_t n = 0;
  for_batch(b, [&](const auto& t, const auto& step, std::size_t k) PIVNP_TILE { update.tile(t, step, k, rare, n); });
  return n;
}

std::size_t smooth(const Elastic& law, const SmoothConstants& s, const StressBatch& b, std::uint32_t* rare) {
  return s.constant ? advance_all<true>(law, s, b, rare) : advance_all<false>(law, s, b, rare);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(smooth);

std::size_t smooth_lanes(const Elastic& elastic, const SmoothConstants& constants, const StressBatch& batch,
                         std::uint32_t* rare) {
  return HWY_DYNAMIC_DISPATCH(smooth)(elastic, constants, batch, rare);
}

}  // namespace pivnp::mpm
#endif

// The surface of the smooth Mohr-Coulomb law in lanes. The formulas are abbo_sloan.hpp's, those of the strength
// strength.cpp's. Included by its source inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_SMOOTH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_SMOOTH_INL
#undef PIVNP_MPM_SMOOTH_INL
#else
#define PIVNP_MPM_SMOOTH_INL
#endif

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
HWY_INLINE LaneTensor times(const LaneTensor& a, V factor) {
  return {a.xx * factor, a.yy * factor, a.zz * factor, a.xy * factor};
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

HWY_INLINE LanePlace choose(M m, const LanePlace& yes, const LanePlace& no) {
  const auto one = [m](V a, V b) HWY_ATTR { return hn::IfThenElse(m, a, b); };
  const LaneStrength &y = yes.strength, &n = no.strength;
  return {choose(m, yes.stress, no.stress),
          choose(m, yes.deviator, no.deviator),
          one(yes.history, no.history),
          one(yes.mean, no.mean),
          one(yes.bar, no.bar),
          one(yes.sin3, no.sin3),
          one(yes.a, no.a),
          one(yes.b, no.b),
          one(yes.a3, no.a3),
          one(yes.b3, no.b3),
          {one(y.sin, n.sin), one(y.cos, n.cos), one(y.cohesion, n.cohesion), one(y.sin_dilatancy, n.sin_dilatancy),
           one(y.friction_by_history, n.friction_by_history), one(y.friction_by_pressure, n.friction_by_pressure),
           one(y.cohesion_by_history, n.cohesion_by_history)},
          one(yes.intercept, no.intercept),
          one(yes.reach, no.reach),
          one(yes.root, no.root),
          one(yes.F, no.F),
          one(yes.size, no.size),
          one(yes.tolerance, no.tolerance),
          one(yes.most_mean, no.most_mean)};
}

// The flow at a place, what it takes from F and what it adds to the history.
struct LaneFlow {
  LaneTensor a, Db;
  V per, hardness, softened;  // softened: no less than a share of the hardness
};
// `constant`: is the strength.
template <bool constant>
struct SmoothSurface {
  const Elastic law;
  const SmoothConstants s;
  const bool is_given;  // is the strain that softens
  V J = zero();         // of the tile
  V given = zero();     // the strain that softens, where it is given from outside
  V tension = zero();   // greatest mean stress, short of the vertex

  HWY_INLINE LaneStrength strength(V history, V mean) const {
    const StrengthConstants& c = s.strength;
    if constexpr (constant)
      return {set(s.sin_friction), set(s.cos_friction), set(c.cohesion), set(s.sin_dilatancy), zero(), zero(), zero()};
    const V strain = is_given ? given : history, left = c.rate > 0 ? hn::Exp(D(), set(-c.rate) * strain) : set(1);
    V peak = set(c.friction), by_pressure = zero();
    if (c.per_half > 0) {
      const V pressure = hn::Neg(mean) / J,
              per = set(1) / hn::MulAdd(hn::Max(zero(), pressure), set(c.per_half), set(1));
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
    return {sin,
            hn::Sqrt((set(1) - sin) * (set(1) + sin)),
            set(c.residual_cohesion) + lost,
            sin_dilatancy,
            rate * above,
            by_pressure,
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
      const auto of = [&](const double(&end)[2][2])
                          HWY_ATTR { return hn::IfThenElse(high, set(end[1][part]), set(end[0][part])); };
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
    p.mean = trace(stress) * set(1.0 / 3);
    p.deviator = deviator_of(stress);
    find(p, history, known);
    return p;
  }
  // The same without mean stress.
  HWY_INLINE LanePlace open_place(const LaneTensor& deviator, V history) const {
    LanePlace p;
    p.stress = p.deviator = deviator;
    p.mean = zero();
    find(p, history, nullptr);
    return p;
  }
  HWY_INLINE void find(LanePlace& p, V history, const LaneStrength* known) const {
    p.history = history;
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
    p.size = hn::Max(hn::Max(c.cohesion * J, hn::Abs(p.mean)), set(s.least_size));
    p.tolerance = set(s.yield_tolerance) * p.size;
    const V vertex = hn::IfThenElse(hn::Gt(c.sin, zero()), set(s.short_of_vertex) * p.intercept / c.sin, hn::Inf(D()));
    p.most_mean = hn::Min(tension, vertex);
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
    const V of_cohesion =
        J * c.cos * c.cohesion_by_history * hn::MulSub(set(s.hyperbola * s.hyperbola), p.intercept / p.root, set(1));
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

  // bar on the surface, at the mean stress and Lode angle.
  HWY_INLINE V bar_on_surface(const LanePlace& p) const {
    const V root = hn::NegMulAdd(p.mean, p.strength.sin, p.intercept), a = set(s.hyperbola) * p.intercept;
    const V squared = hn::MulSub(root, root, a * a), zeros = zero();
    const M there = hn::And(hn::Gt(root, zeros), hn::Gt(squared, zeros));
    return hn::IfThenElseZero(there, hn::Sqrt(squared) / hn::MulAdd(p.b, p.strength.sin, p.a));
  }

  HWY_INLINE LaneFlow flow_at(const LanePlace& p) const {
    LaneFlow f;
    f.a = gradient(p);
    const LaneTensor along = flow(p), dev = deviator_of(along);
    f.Db = stiff(along);
    f.per = hn::Sqrt(set(2.0 / 3) * product(dev, dev));
    f.hardness = product(f.a, f.Db);
    f.softened = hn::Max(hn::NegMulAdd(by_history(p), f.per, f.hardness), set(s.least_hardness) * f.hardness);
    return f;
  }
  // The same at constant mean stress; what the flow dilates by is its sin_dilatancy.
  HWY_INLINE LaneFlow held_flow_at(const LanePlace& p) const {
    LaneFlow f;
    const V sin_angle = p.strength.sin_dilatancy, reach = p.bar * hn::MulAdd(p.b, sin_angle, p.a);
    f.a = deviatoric(p, p.strength.sin, p.reach, p.root);
    const LaneTensor along = deviatoric(p, sin_angle, reach, hyperbola_root(reach, p.intercept));
    f.Db = times(along, set(2 * law.shear));
    f.per = hn::Sqrt(set(2.0 / 3) * product(along, along));
    f.hardness = product(f.a, f.Db);
    f.softened = hn::Max(hn::NegMulAdd(by_history(p), f.per, f.hardness), set(s.least_hardness) * f.hardness);
    return f;
  }

 private:
  static constexpr double root3 = 1.7320508075688772935;
};

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

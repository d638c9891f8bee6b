// The smooth Mohr-Coulomb law in lanes: the algorithm is smooth_mohr_coulomb.cpp's, for the paths that points commonly
// take; what lanes find they cannot do is left to the law's own code (`rare`).
#include "mpm/material/lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/material/smooth_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/material/smooth-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

struct LaneRate {
  LaneTensor stress;
  V history;
};
// A step of a tile's points: stress (turned by the step), history, opening and dissipation become what they are after it,
// except for those of `rare`.
struct LaneState {
  LaneTensor stress;
  V history, opening, dissipated;
  M rare;
};

HWY_INLINE M none() { return hn::Ne(zero(), zero()); }
HWY_INLINE V length(const LaneTensor& a) { return hn::Sqrt(product(a, a)); }
// The part of a step that is done; all of it but for round-off is all.
HWY_INLINE V done_after(V done, V share) {
  const V left = set(1) - done - share;
  return hn::IfThenElse(hn::Lt(left, set(1e-12)), set(1), done + share);
}

template <bool constant>
struct Smooth : SmoothSurface<constant> {
  using Surface = SmoothSurface<constant>;
  using Surface::bar_on_surface, Surface::energy_of, Surface::flow_at, Surface::held_flow_at, Surface::place,
      Surface::open_place, Surface::stiff, Surface::hyperbola_root, Surface::law, Surface::s, Surface::J,
      Surface::given, Surface::tension, Surface::is_given;

  HWY_INLINE M inside(const LanePlace& p) const { return hn::Lt(p.F, set(-s.near_surface) * p.size); }
  HWY_INLINE V within(const LanePlace& p) const { return hn::Min(p.F, zero()); }
  // `on`: those that are at the surface; `way`: to it, from where the substep begins.
  HWY_INLINE LaneRate yielding(const LaneFlow& f, const LaneTensor& elastic, M on, V way) const {
    const V driven = product(f.a, elastic) + way;
    const V amount = hn::IfThenElseZero(hn::And(on, hn::Gt(f.hardness, zero())), hn::Max(zero(), driven / f.softened));
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
      const LaneFlow f = flow_at(p);
      const V amount = p.F / f.softened;
      const LanePlace moved = place(plus(p.stress, f.Db, hn::Neg(amount)), hn::MulAdd(amount, f.per, p.history));
      // Past the surface: only with softening; or no way to it.
      const M lost = hn::Or(hn::Lt(moved.F, hn::Neg(moved.tolerance)), hn::Not(hn::Lt(moved.F, p.F)));
      rare = hn::Or(rare, hn::And(off, hn::Or(lost, hn::Not(hn::Gt(f.hardness, zero())))));
      p = choose(off, moved, p);
    }
    rare = hn::Or(rare, hn::And(wanted, p.outside()));
  }

  // Modified Euler from a place on the surface, each lane with substeps of its own from the share `done` of the step
  // on; the flow there is `at`; lanes that leave the surface, reach the greatest mean stress or need too many go to
  // `rare`.
  struct Flowed {
    LaneTensor stress;
    V history, work;
  };
  HWY_INLINE Flowed substeps(LanePlace here, LaneFlow at, const LaneTensor& de, V done, M yields, M& rare) const {
    const D d;
    constexpr int most = 64;
    const V one = set(1), half = set(0.5);
    const LaneTensor elastic = stiff(de);
    V size = one - done, work = zero();
    M failed = none();
    for (int n = 0; n < most; ++n) {
      const M active = hn::And(hn::AndNot(rare, yields), hn::Lt(done, one));
      if (hn::AllFalse(d, active)) return {here.stress, here.history, work};
      const LaneTensor part = times(elastic, size);
      if (n > 0) {
        at = flow_at(here);
        rare = hn::Or(rare, hn::And(active, hn::Or(inside(here), hn::Lt(product(at.a, elastic), zero()))));
      }
      const V way = within(here);
      const LaneRate first = yielding(at, part, hn::Not(inside(here)), way);
      const LanePlace middle = place(plus(here.stress, first.stress, one), here.history + first.history);
      rare = hn::Or(rare, hn::And(active, middle.at_limit()));
      const M flows = hn::Gt(first.history, zero());
      const LaneRate second = yielding(flow_at(middle), part, hn::Or(flows, hn::Not(inside(middle))), way);
      const LaneTensor stress = plus(plus(here.stress, first.stress, half), second.stress, half);
      const V least = hn::Max(length(stress), set(0.1) * here.size);
      const V error = half * length(plus(second.stress, first.stress, set(-1))) / least;
      const V share =
          hn::IfThenElse(hn::Gt(error, zero()), set(0.9) * hn::Sqrt(set(s.stress_tolerance) / error), set(4));
      const M good =
          hn::And(active, hn::Or(hn::Le(error, set(s.stress_tolerance)), hn::Le(size, set(s.least_substep))));
      const V booked = half * size * (product(here.stress, de) + product(stress, de));
      work = work + hn::IfThenElseZero(good, booked);
      const V history = here.history + half * (first.history + second.history);
      here = place(choose(good, stress, here.stress), hn::IfThenElse(good, history, here.history));
      correct(here, good, rare);
      const V grow = hn::Min(set(4), hn::IfThenElse(failed, hn::Min(share, one), share));
      done = hn::IfThenElse(good, done_after(done, size), done);
      const V next = size * hn::IfThenElse(good, grow, hn::Max(set(0.1), share));
      size = hn::Min(hn::Max(set(s.least_substep), next), one - done);
      failed = hn::AndNot(good, active);
      rare = hn::Or(rare, hn::And(good, hn::And(hn::Lt(done, one), here.at_limit())));
    }
    rare = hn::Or(rare, hn::And(yields, hn::Lt(done, one)));
    return {here.stress, here.history, work};
  }

  // Share of an elastic step `ds` from inside the surface at which F is zero, by the Pegasus method.
  HWY_NOINLINE V crossing(const LanePlace& start, const LaneTensor& ds, V f_high, M wanted, M& rare) const {
    const D d;
    constexpr int most = 16;
    V low = zero(), high = set(1), f_low = start.F, found = zero();
    M active = hn::AndNot(rare, wanted);
    for (int n = 0; n < most; ++n) {
      const V x = hn::NegMulAdd(f_high, (high - low) / (f_high - f_low), high);
      const LanePlace at = place(plus(start.stress, ds, x), start.history, &start.strength);
      found = hn::IfThenElse(active, x, found);
      active = hn::AndNot(hn::Le(hn::Abs(at.F), at.tolerance), active);
      if (hn::AllFalse(d, active)) return found;
      const M beyond = hn::Lt(at.F * f_high, zero());
      low = hn::IfThenElse(beyond, high, low);
      f_low = hn::IfThenElse(beyond, f_high, f_low * (f_high / (f_high + at.F)));
      high = x;
      f_high = at.F;
    }
    rare = hn::Or(rare, active);
    return found;
  }

  // Points that are not open.
  HWY_NOINLINE LaneState advance(LaneState state, LaneTensor de) const {
    const D d;
    M rare = state.rare;
    LanePlace here = place(state.stress, state.history);
    const V start = energy_of(here.stress);
    correct(here, hn::FirstN(d, n_lanes), rare);  // to this step's J and pressure
    rare = hn::Or(rare, here.at_limit());

    const LaneTensor elastic = stiff(de);
    const M within_it = inside(here);
    LaneFlow at = flow_at(here);
    M yields = hn::AndNot(within_it, hn::Ge(product(at.a, elastic), zero()));
    LaneState end{here.stress, here.history, state.opening, zero(), rare};
    V share = zero(), work = zero();  // of the elastic part; at its end
    if (!hn::AllTrue(d, yields)) {
      const LanePlace there = place(plus(here.stress, elastic, set(1)), here.history, &here.strength);
      const M leaves = hn::AndNot(yields, there.outside()),
              over = hn::AndNot(yields, hn::Gt(there.mean, there.most_mean));
      const M crosses = hn::AndNot(hn::Or(rare, over), hn::And(leaves, within_it));
      rare = hn::Or(rare, hn::Or(over, hn::AndNot(within_it, leaves)));
      end.stress = there.stress;
      const LaneTensor before = here.stress;
      share = hn::IfThenElse(yields, zero(), set(1));
      if (!hn::AllFalse(d, crosses)) {
        share = hn::IfThenElse(crosses, crossing(here, elastic, there.F, crosses, rare), share);
        const LaneTensor met = plus(here.stress, elastic, share);
        here = place(choose(crosses, met, here.stress), here.history, &here.strength);
        at = flow_at(here);
        rare = hn::Or(rare, hn::And(crosses, here.at_limit()));
        end.stress = choose(crosses, met, end.stress);
        yields = hn::Or(yields, crosses);
      }
      work = set(0.5) * share * (product(before, de) + product(end.stress, de));
    }
    if (!hn::AllFalse(d, hn::AndNot(rare, yields))) {
      const Flowed flowed = substeps(here, at, de, hn::IfThenElseZero(yields, share), yields, rare);
      end.stress = choose(yields, flowed.stress, end.stress);
      end.history = hn::IfThenElse(yields, flowed.history, end.history);
      work = work + hn::IfThenElseZero(yields, flowed.work);
    }
    end.dissipated = state.dissipated + (work - (energy_of(end.stress) - start));
    end.rare = rare;
    return end;
  }

  // An open point back to the surface, without mean stress.
  HWY_INLINE void correct_open(LanePlace& p) const {
    const M off = p.outside();
    const V keep = hn::IfThenElse(off, hn::Min(set(1), bar_on_surface(p) / p.bar), set(1));
    p.stress = p.deviator = times(p.deviator, keep);
    p.bar = p.bar * keep;
    p.reach = p.reach * keep;
    p.root = hyperbola_root(p.reach, p.intercept);
    p.F = p.root - p.intercept;
  }

  // SmoothMohrCoulomb::open_leg for points that have been open; those that close are left to `rare`.
  HWY_NOINLINE LaneState advance_open(LaneState state, LaneTensor de) const {
    const D d;
    constexpr int most = 200;
    const V one = set(1), half = set(0.5), closed = set(1e-9) * length(de), volume = trace(de);
    const LaneTensor elastic = times(deviator_of(de), set(2 * law.shear));
    const V distortion = length(elastic), start = energy_of(state.stress);
    const double bulk = law.lambda + 2.0 / 3 * law.shear;
    V opening = hn::MulAdd(set(1.0 / (3 * bulk)), trace(state.stress), state.opening);
    M rare = hn::Or(state.rare, hn::Le(opening, closed));
    LanePlace here = open_place(deviator_of(state.stress), state.history);
    correct_open(here);
    V done = zero(), size = zero(), work = zero();
    M failed = none(), steady = none();
    const auto amount_of = [](const LaneFlow& f, V along, V way) HWY_ATTR {
      return hn::IfThenElseZero(hn::Gt(f.hardness, zero()), hn::Max(zero(), (along + way) / f.softened));
    };
    for (int n = 0; n < most; ++n) {
      M active = hn::AndNot(rare, hn::Lt(done, one));
      if (hn::AllFalse(d, active)) break;
      const V right = set(s.stress_tolerance) * here.size, rest = one - done;
      const LaneFlow at = held_flow_at(here);
      const V along = product(at.a, elastic), way_in = within(here), dilates = here.strength.sin_dilatancy;
      const V all = amount_of(at, along * rest, way_in), way = length(plus(times(elastic, rest), at.Db, hn::Neg(all)));
      rare = hn::Or(rare, hn::And(active, hn::Lt(opening + rest * volume, all * dilates)));  // closes
      const M last = hn::Or(steady, hn::Le(way, right)), far = hn::Lt(here.F, hn::Neg(right));
      const M begins = hn::Eq(size, zero());
      const V radius = set(1.4142135623730951) * bar_on_surface(here);
      const V to_surface = hn::IfThenElse(hn::Gt(along, zero()), hn::Neg(here.F) / along, one);
      const V by_error = set(0.9) * hn::Sqrt(set(2) * right * radius * rest / (set(s.corner) * way * distortion));
      size = hn::IfThenElse(begins, hn::IfThenElse(far, to_surface, by_error), size);
      size = hn::IfThenElse(last, rest, hn::Min(hn::Max(size, set(s.least_substep)), rest));

      const LaneTensor part = times(elastic, size);
      const V amount = amount_of(at, along * size, way_in);
      const LaneTensor first = plus(part, at.Db, hn::Neg(amount));
      LaneTensor mean = choose(steady, times(first, zero()), first);
      V flows = amount * at.per, opens = size * volume - amount * dilates, better = one;
      M good = hn::And(active, last);
      if (!hn::AllFalse(d, hn::AndNot(last, active))) {
        const LanePlace middle = open_place(plus(here.stress, first, one), here.history + flows);
        const LaneFlow there = held_flow_at(middle);
        const V again = amount_of(there, product(there.a, part), way_in);
        const LaneTensor second = plus(part, there.Db, hn::Neg(again));
        const V error = half * length(plus(second, first, set(-1)));
        better = hn::IfThenElse(hn::Gt(error, zero()), set(0.9) * hn::Sqrt(right / error), set(4));
        good = hn::And(active, hn::Or(last, hn::Or(hn::Le(error, right), hn::Le(size, set(s.least_substep)))));
        const V way2 = product(first, first), shrunk = way2 - product(first, second);
        steady = hn::And(good, hn::And(hn::Gt(shrunk, zero()), hn::Le(way2 * hn::Sqrt(way2), right * shrunk)));
        mean = choose(last, mean, times(plus(first, second, one), half));
        flows = hn::IfThenElse(last, flows, half * hn::MulAdd(again, there.per, flows));
        const V opens_again = size * volume - again * middle.strength.sin_dilatancy;
        opens = hn::IfThenElse(last, opens, half * (opens + opens_again));
      }
      const LaneTensor stress = plus(here.stress, mean, one);
      work = work + hn::IfThenElseZero(good, half * size * (product(here.stress, de) + product(stress, de)));
      opening = hn::IfThenElse(good, opening + opens, opening);
      rare = hn::Or(rare, hn::And(good, hn::Le(opening, closed)));
      here = open_place(choose(good, stress, here.stress), hn::IfThenElse(good, here.history + flows, here.history));
      correct_open(here);
      done = hn::IfThenElse(good, done_after(done, size), done);
      const V grown = hn::IfThenElse(far, zero(), size * hn::Min(hn::IfThenElse(failed, one, set(4)), better));
      size = hn::IfThenElse(good, grown, size * hn::Max(set(0.1), better));
      failed = hn::AndNot(good, active);
    }
    rare = hn::Or(rare, hn::Lt(done, one));
    return {here.stress, here.history, opening, state.dissipated + (work - (energy_of(here.stress) - start)), rare};
  }
};

template <bool constant>
struct SmoothTiles {
  const StressBatch b;
  Smooth<constant> update;

  template <class Tile, class Step>
  HWY_INLINE LaneState load(const Tile& t, const Step& step) {
    update.J = t.load(b.J);
    if (update.is_given) update.given = t.load(b.softened_by);
    const Turned turn = turned(b, t, step);
    return {{turn.mean + turn.half, turn.mean - turn.half, turn.zz, turn.xy},
            t.load(b.history[plastic::strain]),
            t.load(b.history[plastic::opening]),
            t.load(b.history[plastic::work]),
            none()};
  }
  template <class Step>
  HWY_INLINE LaneTensor strain(const Step& step) const {
    return {step.load(b.de_xx), step.load(b.de_yy), step.load(b.de_zz), step.load(b.de_xy)};
  }
  template <class Tile>
  HWY_INLINE void store(const Tile& t, const LaneState& before, const LaneState& end) const {
    const LaneTensor stress = choose(end.rare, {t.load(b.xx), t.load(b.yy), t.load(b.zz), t.load(b.xy)}, end.stress);
    t.store(stress.xx, b.xx);
    t.store(stress.yy, b.yy);
    t.store(stress.zz, b.zz);
    t.store(stress.xy, b.xy);
    t.store(hn::IfThenElse(end.rare, before.history, end.history), b.history[plastic::strain]);
    t.store(hn::IfThenElse(end.rare, before.dissipated, end.dissipated), b.history[plastic::work]);
  }
};

// Open points are gathered, so that tiles are full of them.
template <bool constant>
HWY_INLINE std::size_t advance_all(const Elastic& law, const SmoothConstants& s, const StressBatch& b,
                                   std::uint32_t* rare) {
  SmoothTiles<constant> tiles{b, {{law, s, b.softened_by != nullptr}}};
  Smooth<constant>& update = tiles.update;
  std::uint32_t open[most_in_lanes];
  std::size_t n = 0, n_open = 0;
  for_batch(b, [&](const auto& t, const auto& step, std::size_t k) PIVNP_TILE {
    LaneState state = tiles.load(t, step);
    const M separated = has_separated(b, k), is_open = hn::Gt(state.opening, zero());
    if (HWY_UNLIKELY(!hn::AllFalse(D(), is_open))) {
      list(hn::And(is_open, separated), k, b.size, open, n_open);
      list(hn::AndNot(separated, is_open), k, b.size, rare, n);
      if (hn::AllTrue(D(), is_open)) return;
    }
    state.rare = is_open;
    update.tension = hn::IfThenElseZero(hn::Not(separated), set(s.tension) * update.J);
    const LaneState end = update.advance(state, tiles.strain(step));
    if (HWY_UNLIKELY(!hn::AllFalse(D(), end.rare))) list(hn::AndNot(is_open, end.rare), k, b.size, rare, n);
    tiles.store(t, state, end);
  });
  update.tension = zero();
  for (std::size_t k = 0; k < n_open; k += n_lanes) {
    const std::size_t size = n_open - k < n_lanes ? n_open - k : n_lanes;
    std::uint32_t places[n_lanes];
    for (std::size_t l = 0; l < size; ++l) places[l] = b.places ? b.places[open[k + l]] : open[k + l];
    const PartTile step(open + k, size), t(places, size);
    const LaneState state = tiles.load(t, step), end = update.advance_open(state, tiles.strain(step));
    if (HWY_UNLIKELY(!hn::AllFalse(D(), end.rare))) {
      std::uint32_t left[n_lanes];
      std::size_t n_left = 0;
      list(end.rare, 0, size, left, n_left);
      for (std::size_t l = 0; l < n_left; ++l) rare[n++] = open[k + left[l]];
    }
    tiles.store(t, state, end);
    t.store(hn::IfThenElse(end.rare, state.opening, end.opening), b.history[plastic::opening]);
  }
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

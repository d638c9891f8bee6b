// The flow's sums over points, and what the points get of it.
#include "mpm/water/pore_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/water/pore_point_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/transfer/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// The hats of a tile's points, and s (1 - s), t (1 - t) in their elements.
template <bool centred>
struct Hats {
  static constexpr int W = centred ? 3 : 2;
  V x[W], y[W], across_x, across_y;

  HWY_INLINE explicit Hats(const Natural& at) {
    along(at.xi, x, across_x);
    along(at.eta, y, across_y);
  }

 private:
  static HWY_INLINE void along(V at, V* w, V& across) {
    if constexpr (centred) {
      const V far = hn::Abs(at), near = set(1) - far;
      w[0] = hn::Max(zero(), hn::Neg(at));
      w[1] = near;
      w[2] = hn::Max(zero(), at);
      across = far * near;
    } else {
      w[0] = set(1) - at;
      w[1] = at;
      across = w[0] * w[1];
    }
  }
};

template <bool centred, class Tile>
HWY_INLINE Natural place_of(const PointView& p, const CellView& c, const TileCells& cells, const Tile& t) {
  if constexpr (centred) return natural<BSplineShape>(p, c, cells, t);
  else return natural<BilinearShape>(p, c, cells, t);
}
template <bool centred, class Tile>
HWY_INLINE Hats<centred> hats_of(const PointView& p, const CellView& c, const TileCells& cells, const Tile& t) {
  return Hats<centred>(place_of<centred>(p, c, cells, t));
}

template <class Tile>
HWY_INLINE V head_of(const PointView& p, const PoreView& w, const Tile& t) {
  return hn::MulAdd(set(w.head_x), t.load(p.x), hn::MulAdd(set(w.head_y), t.load(p.y), set(w.head_0)));
}
template <class Tile>
HWY_INLINE V mobility_of(const PoreView& w, const Tile& t) {
  return w.mobility ? t.load(w.mobility) : set(w.mobility_all);
}
template <class Tile>
HWY_INLINE M holds_water(const Tile& t, V content, V mobility) {
  return hn::And(hn::Gt(t.own(content), zero()), hn::Ge(mobility, zero()));
}

constexpr std::ptrdiff_t numbers_in_sums = sizeof(PoreNode) / sizeof(double);
static_assert(sizeof(PoreElement) == sizeof(PoreNode));

template <bool centred>
void map_run(const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  constexpr int W = centred ? 3 : 2;
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Natural place = place_of<centred>(p, c, cells, t);
    const Hats<centred> hats(place), of_other({InPairs::swapped(place.xi), InPairs::swapped(place.eta)});
    const V mobility = mobility_of(w, t), J = t.load(p.J);
    const V v0 = hn::IfThenElseZero(holds_water(t, t.load(w.content), mobility), t.live(t.load(p.volume0)));
    const V v = v0 * J, e = t.load(w.pressure) - head_of(p, w, t), conducts = w.mobility ? v * mobility : v;
    const V mobile = w.mobility && !w.projected ? conducts : v0 * (J - (w.solid ? t.load(w.solid) : set(w.solid_all)));
    const InPairs of_node[] = {{v, v * e}, {v0 * (J - t.load(w.J_flow)), mobile}};
    // (By value: what the stores below change might be what it is looked up from.)
    const std::ptrdiff_t nx = c.nx;
    double *to_node[groups], *to_element[groups];
    for (std::size_t g = 0; g < groups; ++g) {
      to_node[g] = &sums_of.node[cells.base[g] - c.node].volume;
      to_element[g] = &sums_of.element[cells.base[g] - c.node].inside;
    }
    const auto behind = [nx](double* const* first, int a, int b) PIVNP_TILE {
      return [first, n = (b * nx + a) * numbers_in_sums](std::size_t g) PIVNP_TILE { return first[g] + n; };
    };
#pragma GCC unroll 3
    for (int b = 0; b < W; ++b) {
      V own[2], other[2], sums[2];
      for (int k = 0; k < 2; ++k) {
        own[k] = of_node[k].own * hats.y[b];
        other[k] = of_node[k].other * of_other.y[b];
      }
#pragma GCC unroll 3
      for (int a = 0; a < W; ++a) {
        for (int k = 0; k < 2; ++k) sums[k] = hn::MulAdd(own[k], hats.x[a], other[k] * of_other.x[a]);
        add_sums(D(), sums_of_pairs(D(), sums[0], sums[1]), behind(to_node, a, b));
      }
    }
    const InPairs of_element[] = {{v, v * hats.across_x}, {v * hats.across_y, conducts}};
    if constexpr (centred) {
      const V none = zero();
      const M left = hn::Gt(hats.x[0], none), below = hn::Gt(hats.y[0], none);
      const M other_left = hn::Gt(of_other.x[0], none), other_below = hn::Gt(of_other.y[0], none);
      V parts[2][4];
      for (int k = 0; k < 2; ++k) {
        const V own = of_element[k].own, other = of_element[k].other;
        const V in_left = hn::IfThenElseZero(left, own), in_right = hn::IfThenZeroElse(left, own);
        const V other_in_left = hn::IfThenElseZero(other_left, other), other_in_right = hn::IfThenZeroElse(other_left, other);
        parts[k][0] = hn::IfThenElseZero(below, in_left) + hn::IfThenElseZero(other_below, other_in_left);
        parts[k][1] = hn::IfThenElseZero(below, in_right) + hn::IfThenElseZero(other_below, other_in_right);
        parts[k][2] = hn::IfThenZeroElse(below, in_left) + hn::IfThenZeroElse(other_below, other_in_left);
        parts[k][3] = hn::IfThenZeroElse(below, in_right) + hn::IfThenZeroElse(other_below, other_in_right);
      }
#pragma GCC unroll 4
      for (int n = 0; n < 4; ++n) add_sums(D(), sums_of_pairs(D(), parts[0][n], parts[1][n]), behind(to_element, n % 2, n / 2));
    } else {
      add_sums(D(), sums_of_pairs(D(), of_element[0].own + of_element[0].other, of_element[1].own + of_element[1].other), behind(to_element, 0, 0));
    }
  });
}

// Of the nodes' numbers what the hats span at the points.
template <bool centred>
HWY_INLINE V spanned(const Hats<centred>& hats, const CellView& c, const TileCells& cells, const double* values) {
  constexpr int W = centred ? 3 : 2;
  const double *first = values + (cells.base[0] - c.node), *second = values + (cells.base[groups - 1] - c.node);
  V sum = zero();
#pragma GCC unroll 3
  for (int b = 0; b < W; ++b) {
    const auto of = [&](int a) PIVNP_TILE { return of_groups(first[b * c.nx + a], second[b * c.nx + a]); };
    V row = hats.x[0] * of(0);
#pragma GCC unroll 3
    for (int a = 1; a < W; ++a) row = hn::MulAdd(hats.x[a], of(a), row);
    sum = hn::MulAdd(hats.y[b], row, sum);
  }
  return sum;
}

// What a tile's points hold from here on.
template <class Tile>
HWY_INLINE void keep(const PointView& p, const PoreView& w, const Tile& t, M holds, V mobility, V J, V content, V pressure) {
  const V outside = set(w.outside) * hn::Max(zero(), set(w.level) - t.load(p.y));
  V seen = hn::IfThenElse(holds, pressure, outside);
  if (w.mobility) seen = hn::IfThenZeroElse(hn::Eq(mobility, set(no_pores_mobility)), seen);
  t.store(content, w.content);
  t.store(seen, w.pressure);
  t.store(J, w.J_flow);
}

template <bool centred>
double change_run(double rate, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f, Range range) {
  V lost = zero();
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Hats<centred> hats = hats_of<centred>(p, c, cells, t);
    const V mobility = mobility_of(w, t), J = t.load(p.J), content = t.load(w.content), head = head_of(p, w, t);
    const V solid = w.solid ? t.load(w.solid) : set(w.solid_all);
    const M holds = holds_water(t, content, mobility);
    const V v0 = hn::IfThenElseZero(holds, t.live(t.load(p.volume0)));
    const V e = t.load(w.pressure) - head, per_step = set(rate);
    const V flowed_in = spanned(hats, c, cells, f.change);
    const V own = w.mobility ? spanned(hats, c, cells, f.rate) : mobility;
    const V flowed = hn::NegMulAdd(per_step * own, e, flowed_in);
    const V fed = J * spanned(hats, c, cells, f.even);
    const V evened = content + ((J - t.load(w.J_flow)) - fed), more = J * flowed;
    const V bulk = set(w.bulk), pores = hn::Max(set(least_pores), J - solid), per_pores = bulk / pores;
    const V swollen = w.swelling ? evened + t.load(w.swelling) : evened;
    const V after = evened + more;
    V pressure = hn::MulSub(per_pores, w.swelling ? swollen + more : after, bulk);
    V before = hn::MulSub(per_pores, swollen, bulk), mean = hn::MulAdd(set(0.5) * per_pores, more, before);
    if (w.tears) {
      pressure = hn::Max(zero(), pressure);
      before = hn::Max(zero(), before);
      mean = set(0.5) * (before + pressure);
    }
    lost = lost - v0 * more * (mean - head);
    keep(p, w, t, holds, mobility, J, hn::IfThenElse(holds, after, content), pressure);
    if (w.smooths_flow) t.store(J + hn::IfThenElseZero(holds, more), w.J_flow);
  });
  return sum_of(lost);
}

template <bool centred>
PoreLosses project_run(const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f, const double* share, Range range) {
  V all = zero(), by_flow = zero();
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Hats<centred> hats = hats_of<centred>(p, c, cells, t);
    const V mobility = mobility_of(w, t), J = t.load(p.J), content = t.load(w.content), pressure = t.load(w.pressure);
    const M holds = holds_water(t, content, mobility);
    const V v0 = hn::IfThenElseZero(holds, t.live(t.load(p.volume0)));
    const V head = head_of(p, w, t), e = pressure - head, strain = J - t.load(w.J_flow);
    const V gained = hn::NegMulAdd(spanned(hats, c, cells, share), e, spanned(hats, c, cells, f.even));
    const V more = J * spanned(hats, c, cells, f.change);
    const V after = content + (strain - J * spanned(hats, c, cells, f.mean)) + more;
    const V half = set(0.5) * gained, pores = hn::Max(set(least_pores), J - (w.solid ? t.load(w.solid) : set(w.solid_all)));
    by_flow = by_flow - v0 * more * (half + e);
    all = all + v0 * ((after - content) * head - (half + pressure) * strain - pores * set(1 / w.bulk) * gained * (half + pressure));
    keep(p, w, t, holds, mobility, J, hn::IfThenElse(holds, after, content), pressure + gained);
  });
  return {sum_of(all), sum_of(by_flow)};
}

PoreLosses project_range(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f, const double* share,
                     Range range) {
  return centred ? project_run<true>(p, w, c, f, share, range) : project_run<false>(p, w, c, f, share, range);
}
void map_range(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  if (centred) map_run<true>(p, w, c, sums_of, range);
  else map_run<false>(p, w, c, sums_of, range);
}

double change_range(bool centred, double rate, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f, Range range) {
  return centred ? change_run<true>(rate, p, w, c, f, range) : change_run<false>(rate, p, w, c, f, range);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(map_range);
HWY_EXPORT(change_range);
HWY_EXPORT(project_range);

void map_pores_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  HWY_DYNAMIC_DISPATCH(map_range)(centred, p, w, c, sums_of, range);
}
PoreLosses project_points_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f,
                            const double* share, Range range) {
  return HWY_DYNAMIC_DISPATCH(project_range)(centred, p, w, c, f, share, range);
}
double change_points_lanes(bool centred, double rate, const PointView& p, const PoreView& w, const CellView& c,
                           const PoreFields& f, Range range) {
  return HWY_DYNAMIC_DISPATCH(change_range)(centred, rate, p, w, c, f, range);
}

}  // namespace pivnp::mpm
#endif

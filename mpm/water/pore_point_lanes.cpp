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
      w[2] = hn::Max(zero(), at);
      w[1] = near;
      w[0] = w[2] - at;  // exactly, as one of the two is zero
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
HWY_INLINE V weight_of(const PointView& p, const PoreView& w, const Tile& t) {
  return hn::MulAdd(set(w.head_x), t.again(p.x), hn::MulAdd(set(w.head_y), t.again(p.y), set(w.head_0)));
}
template <class Tile>
HWY_INLINE V outside_of(const PointView& p, const PoreView& w, const Tile& t) {
  return set(w.outside) * hn::Max(zero(), set(w.level) - t.again(p.y));
}
// Pressure without potential.
template <class Tile>
HWY_INLINE V head_of(const PointView& p, const PoreView& w, const Tile& t) {
  return w.imposed ? outside_of(p, w, t) : weight_of(p, w, t);
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

// Of a row of nodes from each cell's first one on, what a tile's lanes add to them: four numbers, in two pairs.
struct Pairs {
  V of[2];
};

// a, and where m holds b besides.
HWY_INLINE V plus_where(M m, V a, V b) { return hn::IfThenElse(m, a + b, a); }

// Sums over the lanes for one row of W nodes of each cell, along a row of cells: what the next cells add to as well is
// kept until nothing more comes, and lanes are added up then. So a node's numbers are read and written once a row of
// cells, two nodes together with eight lanes, and not by every cell.
template <int W>
class RowSums {
 public:
  // Of cells that follow each other and those before: to the nodes from `at` on.
  template <class Tag>
  HWY_INLINE void follow(Tag d, const Pairs (&now)[W], double* at) {
    V done[2];
    for (int k = 0; k < 2; ++k) done[k] = take(d, now, k);
    const V sums = sums_of_pairs(d, done[0], done[1]);
    hn::StoreU(hn::LoadU(d, at) + sums, d, at);
  }
  // What is kept, to the nodes from `at` on.
  template <class Tag>
  HWY_INLINE void finish(Tag d, double* at) {
    if constexpr (groups == 2 && W > 1) {
      const V sums = sums_of_pairs(d, kept_[0].of[0], kept_[0].of[1]);
      const hn::Half<Tag> h;
      add(h, hn::LowerHalf(h, sums), at);
      if constexpr (W > 2) add(h, hn::UpperHalf(h, sums), at + numbers_in_sums);
    } else {
      for (int a = 0; a + 1 < W; ++a)
        add(d, sums_of_pairs(d, kept_[a].of[0], kept_[a].of[1]), at + a * numbers_in_sums);
    }
    forget();
  }
  HWY_INLINE void forget() {
    for (Pairs& p : kept_)
      for (V& v : p.of) v = zero();
  }

 private:
  template <class Tag, class Values>
  static HWY_INLINE void add(Tag d, Values v, double* at) {
    hn::StoreU(hn::LoadU(d, at) + v, d, at);
  }
  // Keeps what nodes further on get of a pair; what is done.
  template <class Tag>
  HWY_INLINE V take(Tag d, const Pairs (&now)[W], int k) {
    if constexpr (groups == 1) {
      const V done = W > 1 ? now[0].of[k] + kept_[0].of[k] : now[0].of[k];
      if constexpr (W > 2) kept_[0].of[k] = now[1].of[k] + kept_[1].of[k];
      if constexpr (W > 1) kept_[W - 2].of[k] = now[W - 1].of[k];
      return done;
    } else {
      // The second cell's nodes are those of the first one, one further on.
      const M first = hn::FirstN(d, group_lanes);
      const auto other_half = [d](V v) PIVNP_TILE { return hn::ConcatLowerUpper(d, v, v); };
      if constexpr (W == 1) {
        return now[0].of[k];
      } else {
        const V across = other_half(now[1].of[k]), before = now[0].of[k] + kept_[0].of[k];
        kept_[0].of[k] = W == 2 ? hn::IfThenElseZero(first, across) : plus_where(first, now[W - 1].of[k], across);
        return plus_where(hn::Not(first), before, across);
      }
    }
  }

  static constexpr int most_kept = groups == 2 ? 1 : W > 1 ? W - 1 : 1;
  Pairs kept_[most_kept];
};

// The same for all rows of a cell's nodes.
template <int W>
class CellSums {
 public:
  HWY_INLINE explicit CellSums(std::ptrdiff_t nx) : nx_(nx * numbers_in_sums) {
    for (RowSums<W>& row : rows_) row.forget();
  }
  // parts(b, now): the row b's. at: of each group's cell, the first node's numbers.
  template <class Parts>
  HWY_INLINE void add(double* const* at, Parts&& parts) {
    const bool in_row = groups == 1 || at[groups - 1] == at[0] + numbers_in_sums;
    if (HWY_UNLIKELY(at[0] != next_ || !in_row)) finish();
    if (HWY_LIKELY(in_row)) {
#pragma GCC unroll 3
      for (int b = 0; b < W; ++b) {
        Pairs now[W];
        parts(b, now);
        rows_[b].follow(D(), now, at[0] + b * nx_);
      }
      next_ = at[0] + std::ptrdiff_t(groups) * numbers_in_sums;
    } else {
      for (int b = 0; b < W; ++b) {
        Pairs now[W];
        parts(b, now);
        for (int a = 0; a < W; ++a)
          add_sums(D(), sums_of_pairs(D(), now[a].of[0], now[a].of[1]),
                   [&](std::size_t g) PIVNP_TILE { return at[g] + b * nx_ + a * numbers_in_sums; });
      }
    }
  }
  HWY_INLINE void finish() {
    if (next_)
      for (int b = 0; b < W; ++b) rows_[b].finish(D(), next_ + b * nx_);
    next_ = nullptr;
  }

 private:
  RowSums<W> rows_[W];
  double* next_ = nullptr;  // of the cell that would follow; null: nothing is kept
  std::ptrdiff_t nx_;
};

template <bool centred>
void map_run(const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  constexpr int W = centred ? 3 : 2, E = W - 1;
  CellSums<W> nodes(c.nx);
  CellSums<E> elements(c.nx);
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Natural place = place_of<centred>(p, c, cells, t);
    const Hats<centred> hats(place), of_other({InPairs::swapped(place.xi), InPairs::swapped(place.eta)});
    const V mobility = mobility_of(w, t), J = t.load(p.J);
    const V v0 = hn::IfThenElseZero(holds_water(t, t.load(w.content), mobility), t.live(t.load(p.volume0)));
    const V v = v0 * J, e = t.load(w.pressure) - head_of(p, w, t), conducts = w.mobility ? v * mobility : v;
    const V mobile = w.mobility ? conducts : v0 * (J - set(w.solid_all));
    const InPairs of_node[] = {{v, conducts * e}, {v0 * (J - t.load(w.J_flow)), mobile}};
    double *to_node[groups], *to_element[groups];
    for (std::size_t g = 0; g < groups; ++g) {
      to_node[g] = &sums_of.node[cells.base[g] - c.node].volume;
      to_element[g] = &sums_of.element[cells.base[g] - c.node].inside;
    }
    nodes.add(to_node, [&](int b, Pairs* now) PIVNP_TILE {
      for (int k = 0; k < 2; ++k) {
        const V own = of_node[k].own * hats.y[b], other = of_node[k].other * of_other.y[b];
#pragma GCC unroll 3
        for (int a = 0; a < W; ++a) now[a].of[k] = hn::MulAdd(own, hats.x[a], other * of_other.x[a]);
      }
    });
    const InPairs of_element[] = {{v, v * hats.across_x}, {v * hats.across_y, conducts}};
    if constexpr (centred) {
      const V none = zero();
      const M left = hn::Gt(hats.x[0], none), other_left = hn::Gt(of_other.x[0], none);
      const M below = hn::Gt(hats.y[0], none), other_below = hn::Gt(of_other.y[0], none);
      elements.add(to_element, [&](int b, Pairs* now) PIVNP_TILE {
        const auto in_row = [b](M lower, V of) PIVNP_TILE {
          return b == 0 ? hn::IfThenElseZero(lower, of) : hn::IfThenZeroElse(lower, of);
        };
        for (int k = 0; k < 2; ++k) {
          const V own = in_row(below, of_element[k].own), other = in_row(other_below, of_element[k].other);
          now[0].of[k] = plus_where(other_left, hn::IfThenElseZero(left, own), other);
          now[E - 1].of[k] = hn::IfThenZeroElse(left, own) + hn::IfThenZeroElse(other_left, other);
        }
      });
    } else {
      elements.add(to_element, [&](int, Pairs* now) PIVNP_TILE {
        for (int k = 0; k < 2; ++k) now[0].of[k] = of_element[k].own + of_element[k].other;
      });
    }
  });
  nodes.finish();
  elements.finish();
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
  V seen = hn::IfThenElse(holds, pressure, outside_of(p, w, t));
  if (w.mobility) seen = hn::IfThenZeroElse(hn::Eq(mobility, set(no_pores_mobility)), seen);
  t.store(content, w.content);
  t.store(seen, w.pressure);
  t.store(J, w.J_flow);
}

template <bool centred>
PoreChange change_run(double rate, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f,
                      Range range) {
  V lost = zero(), lifted = zero();
  for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
    const Hats<centred> hats = hats_of<centred>(p, c, cells, t);
    const V mobility = mobility_of(w, t), J = t.load(p.J), content = t.load(w.content), head = head_of(p, w, t);
    const V solid = w.solid ? t.load(w.solid) : set(w.solid_all);
    const M holds = holds_water(t, content, mobility);
    const V v0 = hn::IfThenElseZero(holds, t.live(t.load(p.volume0)));
    const V e = t.load(w.pressure) - head, per_step = set(rate);
    const V flowed_in = spanned(hats, c, cells, f.change);
    const V flowed = w.mobility ? mobility * hn::NegMulAdd(per_step, e, flowed_in)
                                : hn::NegMulAdd(per_step * mobility, e, flowed_in);
    const V fed = J * spanned(hats, c, cells, f.even);
    const V evened = content + ((J - t.load(w.J_flow)) - fed), more = J * flowed;
    const V bulk = set(w.bulk), pores = hn::Max(set(least_pores), J - solid), per_pores = bulk / pores;
    const V after = evened + more;
    V pressure = hn::MulSub(per_pores, w.swelling ? evened + t.load(w.swelling) + more : after, bulk);
    if (w.imposed) pressure = hn::Max(zero(), pressure);
    // (Water flows while the skeleton is strained: at the mean of the potentials before and after both.)
    lost = lost - v0 * more * (set(0.5) * (e + (pressure - head)));
    if (w.imposed) lifted = hn::NegMulAdd(v0 * (after - content), weight_of(p, w, t) - head, lifted);
    keep(p, w, t, holds, mobility, J, hn::IfThenElse(holds, after, content), pressure);
    if (w.smooths_flow) t.store(J + hn::IfThenElseZero(holds, more), w.J_flow);
  });
  return {sum_of(lost), sum_of(lifted)};
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
    const V flowed = spanned(hats, c, cells, f.change), more = J * (w.mobility ? mobility * flowed : flowed);
    const V after = content + (strain - J * spanned(hats, c, cells, f.mean)) + more;
    const V half = set(0.5) * gained, pores = hn::Max(set(least_pores), J - (w.solid ? t.load(w.solid) : set(w.solid_all)));
    by_flow = by_flow - v0 * more * (half + e);
    all = all + v0 * ((after - content) * head - (half + pressure) * strain - pores * set(1 / w.bulk) * gained * (half + pressure));
    keep(p, w, t, holds, mobility, J, hn::IfThenElse(holds, after, content), pressure + gained);
  });
  return {sum_of(all), sum_of(by_flow)};
}

// (The energy as stored_kinetic() has it.)
double carry_range(const PointView& p, const PoreView& w, const std::int32_t* cell, const PoreMasses& of,
                   Range& points) {
  V brought = zero();
  const V none = zero();
  for (; points.begin + n_lanes <= points.end; points.begin += n_lanes) {
    const FullTile t{std::uint32_t(points.begin)};
    HWY_ALIGN double simulated[n_lanes];
    for (std::size_t l = 0; l < n_lanes; ++l) simulated[l] = cell[points.begin + l] < 0 ? 0 : 1;
    const V content = t.load(w.content), before = t.load(p.mass);
    M holds = hn::Gt(hn::Load(D(), simulated), none);
    if (!of.empty_too) holds = hn::And(holds, hn::Gt(content, none));
    const V mass = hn::IfThenElse(holds, t.load(p.volume0) * hn::MulAdd(set(of.water), content, set(of.dry)), before);
    const V vx = t.load(p.vx), vy = t.load(p.vy);
    V energy = set(0.5) * hn::MulAdd(vx, vx, vy * vy);
    if (p.C_xx) {
      const V xx = t.load(p.C_xx), yx = t.load(p.C_yx), xy = t.load(p.C_xy), yy = t.load(p.C_yy);
      energy = hn::MulAdd(set(0.125 * of.hx * of.hx), hn::MulAdd(xx, xx, yx * yx), energy);
      energy = hn::MulAdd(set(0.125 * of.hy * of.hy), hn::MulAdd(xy, xy, yy * yy), energy);
    }
    t.store(mass, p.mass);
    brought = brought + hn::IfThenElseZero(holds, (mass - before) * energy);
  }
  return sum_of(brought);
}

PoreLosses project_range(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f, const double* share,
                     Range range) {
  return centred ? project_run<true>(p, w, c, f, share, range) : project_run<false>(p, w, c, f, share, range);
}
void map_range(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  if (centred) map_run<true>(p, w, c, sums_of, range);
  else map_run<false>(p, w, c, sums_of, range);
}

PoreChange change_range(bool centred, double rate, const PointView& p, const PoreView& w, const CellView& c,
                        const PoreFields& f, Range range) {
  return centred ? change_run<true>(rate, p, w, c, f, range) : change_run<false>(rate, p, w, c, f, range);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(map_range);
HWY_EXPORT(change_range);
HWY_EXPORT(project_range);
HWY_EXPORT(carry_range);

void map_pores_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreSumsView& sums_of, Range range) {
  HWY_DYNAMIC_DISPATCH(map_range)(centred, p, w, c, sums_of, range);
}
PoreLosses project_points_lanes(bool centred, const PointView& p, const PoreView& w, const CellView& c, const PoreFields& f,
                            const double* share, Range range) {
  return HWY_DYNAMIC_DISPATCH(project_range)(centred, p, w, c, f, share, range);
}
PoreChange change_points_lanes(bool centred, double rate, const PointView& p, const PoreView& w, const CellView& c,
                               const PoreFields& f, Range range) {
  return HWY_DYNAMIC_DISPATCH(change_range)(centred, rate, p, w, c, f, range);
}

double carry_water_lanes(const PointView& p, const PoreView& w, const std::int32_t* cell, const PoreMasses& of,
                         Range& points) {
  return HWY_DYNAMIC_DISPATCH(carry_range)(p, w, cell, of, points);
}

}  // namespace pivnp::mpm
#endif

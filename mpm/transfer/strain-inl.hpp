// A.12 in lanes: log strain and rotation of the step. Included by the kernels' sources inside Highway's loop over instruction
// sets.
#if defined(PIVNP_MPM_STRAIN_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_STRAIN_INL
#undef PIVNP_MPM_STRAIN_INL
#else
#define PIVNP_MPM_STRAIN_INL
#endif

#include <algorithm>
#include <type_traits>

#include "mpm/simd/turns-inl.hpp"
#include "mpm/transfer/lanes-inl.hpp"
#include "mpm/transfer/polar-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// The strain-rate velocity of a tile's nodes.
template <bool marked>
struct StrainVelocityAt {
  const double* first[groups];
  std::ptrdiff_t next[groups];

  HWY_INLINE StrainVelocityAt(const CellView& c, const TileCells& cells) {
    for (std::size_t g = 0; g < groups; ++g) {
      const bool apart = marked && cells.marks[g] & strained_apart;
      next[g] = apart ? 2 : c.to_next;
      first[g] = (apart ? c.own_strain_velocity : c.strain_velocity) + (cells.base[g] - c.node) * next[g];
    }
  }
  /// x and y in turn.
  HWY_INLINE V both(std::ptrdiff_t n) const {
    return load_in_turn(first[0] + n * next[0], first[groups - 1] + n * next[groups - 1]);
  }
  HWY_INLINE V operator()(std::ptrdiff_t n, int component) const {
    return of_groups(first[0][n * next[0] + component], first[groups - 1][n * next[groups - 1] + component]);
  }
};

// That which was mapped to them.
struct MappedVelocityAt {
  const double* first[groups];

  HWY_INLINE explicit MappedVelocityAt(const TileCells& cells) {
    for (std::size_t g = 0; g < groups; ++g) first[g] = &cells.base[g]->vx;
  }
  HWY_INLINE V both(std::ptrdiff_t n) const {
    constexpr std::ptrdiff_t next = sizeof(Node) / sizeof(double);
    return load_in_turn(first[0] + n * next, first[groups - 1] + n * next);
  }
};

template <class Lines>
HWY_INLINE LaneGradient gradient(const Lines& l, const CellView& view, const TileCells& cells, double sx, double sy) {
  const StrainVelocityAt<Lines::marked> u(view, cells);
  constexpr int W = Lines::W;
  const V x = set(sx), y = set(sy);
  if constexpr (Lines::Shape::linear) {
    // Linear along each axis, with the cross difference in common.
    const auto of = [&](int component, V& by_x, V& by_y) PIVNP_TILE {
      const V a = u(0, component), b = u(1, component), e = u(cells.nx, component), f = u(cells.nx + 1, component);
      const V low = b - a, cross = (f - e) - low;
      by_x = hn::MulAdd(l.eta, cross, low) * x;
      by_y = hn::MulAdd(l.xi, cross, e - a) * y;
    };
    LaneGradient G;
    of(0, G.xx, G.xy);
    of(1, G.yx, G.yy);
    return G;
  } else {
    LaneGradient G{zero(), zero(), zero(), zero()};
    for (int b = 0; b < W; ++b) {
      const auto add = [&](int component, V& by_x, V& by_y) PIVNP_TILE {
        V value = zero(), slope = zero();
        for (int a = 0; a < W; ++a) {
          const V v = u(b * cells.nx + a, component);
          value = hn::MulAdd(l.x.w[a], v, value);
          slope = hn::MulAdd(l.x.g[a], v, slope);
        }
        by_x = hn::MulAdd(l.y.w[b], slope, by_x);
        by_y = hn::MulAdd(l.y.g[b], value, by_y);
      };
      add(0, G.xx, G.xy);
      add(1, G.yx, G.yy);
    }
    return {G.xx * x, G.xy * y, G.yx * x, G.yy * y};
  }
}

// Splines are polynomials of the second degree in a cell away from walls: of the parabola a + b s + c s^2 through the
// three nodes of an axis, a + c/4 + b xi + c xi^2. The coefficients are those of the cell, both components in turn:
// from them the sums over its nodes need half the products, and no shape functions.
struct Parabola {
  V a, b, c;  // a + c/4, twice b, c
  HWY_INLINE Parabola(V low, V middle, V high) : b(high - low), c(hn::MulSub(set(0.5), low + high, middle)) {
    a = hn::MulAdd(set(0.25), c, middle);
  }
};
class CellPolynomials {
 public:
  template <class Shape>
  static constexpr bool are_of = std::is_same_v<Shape, BSplineShape>;
  /// Of a velocity of the nodes, where hold(). The strain-rate velocity is the updated one where one sweep moves and strains,
  /// but in cells strained apart.
  template <class VelocityAt>
  HWY_INLINE CellPolynomials(const VelocityAt& u, const TileCells& cells)
      : CellPolynomials(row(u, 0), row(u, cells.nx), row(u, 2 * cells.nx)) {}
  static HWY_INLINE bool hold(const TileCells& cells) {
    return !(cells.any_mark() & (wall_left | wall_right | wall_down | wall_up | wall_moved));
  }

  /// `of` takes one component of a coefficient to all lanes of its cell. Twice `by` is what the second power along x
  /// takes where the first takes 2: 4 xi for the slope; the rows' sum by 1, y and y^2, y halved in y1.
  template <class Of>
  HWY_INLINE V across(Of&& of, V by, V y1, V y2) const {
    const auto row = [&](const Parabola& first, const Parabola& second, V Parabola::*k)
                         PIVNP_TILE { return hn::MulAdd(by, of(second.*k), of(first.*k)); };
    return hn::MulAdd(y2, row(along_, square_, &Parabola::c),
                      hn::MulAdd(y1, row(along_, square_, &Parabola::b), row(along_, square_, &Parabola::a)));
  }
  struct Rows {  // values at xi of the coefficients along y
    V a, b, c;
    HWY_INLINE V up(V y1, V y2) const { return hn::MulAdd(y2, c, hn::MulAdd(y1, b, a)); }
    HWY_INLINE V along(V by) const { return hn::MulAdd(by, c, b); }
  };
  template <class Of>
  HWY_INLINE Rows rows(Of&& of, V x1, V x2) const {
    const auto at = [&](V Parabola::*k) PIVNP_TILE {
      return hn::MulAdd(x2, of(square_.*k), hn::MulAdd(x1, of(along_.*k), of(one_.*k)));
    };
    return {at(&Parabola::a), at(&Parabola::b), at(&Parabola::c)};
  }

 private:
  HWY_INLINE CellPolynomials(const Parabola& low, const Parabola& middle, const Parabola& high)
      : one_(low.a, middle.a, high.a), along_(low.b, middle.b, high.b), square_(low.c, middle.c, high.c) {}
  template <class VelocityAt>
  static HWY_INLINE Parabola row(const VelocityAt& u, std::ptrdiff_t n) {
    return {u.both(n), u.both(n + 1), u.both(n + 2)};
  }

  Parabola one_, along_, square_;  // of the powers of xi, along y
};

// The gradient of the step by them.
HWY_INLINE LaneGradient gradient(const CellPolynomials& v, const Natural& at, double sx, double sy) {
  const V x1 = set(0.5) * at.xi, y1 = set(0.5) * at.eta, x2 = at.xi * at.xi, y2 = at.eta * at.eta, x = set(0.5 * sx),
          y = set(0.5 * sy);
  const auto component = [&](auto&& of, V& by_x, V& by_y) PIVNP_TILE {
    by_x = x * v.across(of, set(4) * at.xi, y1, y2);
    by_y = y * v.rows(of, x1, x2).along(set(4) * at.eta);
  };
  LaneGradient G;
  component([](V k) PIVNP_TILE { return first_of_turn(k); }, G.xx, G.xy);
  component([](V k) PIVNP_TILE { return second_of_turn(k); }, G.yx, G.yy);
  return G;
}

// Of a tile's own points: what follows from it chooses its way by all lanes.
template <class Tile>
HWY_INLINE LaneGradient of_own(const Tile& t, const LaneGradient& G) {
  return {t.own(G.xx), t.own(G.xy), t.own(G.yx), t.own(G.yy)};
}

// ln det of the step at the points, to be averaged: nothing in lanes without one, where it need not be a number.
template <bool round, class Tile, class Lines>
HWY_INLINE V dilation([[maybe_unused]] const PointView& p, const Tile& t, const Lines& l, const CellView& c, const TileCells& cells, double sx, double sy) {
  const V theta = lane_log_det(of_own(t, gradient(l, c, cells, sx, sy)));
  if constexpr (round) return t.live(theta + t.load(p.hoop));
  else return t.live(theta);
}

// The gradient at the elements' centres.
template <bool marked>
HWY_INLINE LaneGradient centre_gradient(const CellView& view, const TileCells& cells, double sx, double sy) {
  const StrainVelocityAt<marked> u(view, cells);
  const auto of = [&](int component, V& by_x, V& by_y) PIVNP_TILE {
    const V a = u(0, component), b = u(1, component), e = u(cells.nx, component), f = u(cells.nx + 1, component);
    by_x = set(0.5 * sx) * ((b - a) + (f - e));
    by_y = set(0.5 * sy) * ((e - a) + (f - b));
  };
  LaneGradient G;
  of(0, G.xx, G.xy);
  of(1, G.yx, G.yy);
  return G;
}

constexpr std::size_t most_elements = 32;  // averaged at a time

// The full tile whose gradient is known and whose strain waits until that of the next one is known. Their chains of
// operations depend on nothing of each other and go together; one tile's alone is as long as what the processor looks
// ahead.
class WaitingStrain {
 public:
  template <class Straining, class Tile>
  HWY_INLINE void strain(const Straining& by, const Tile& t, const Natural& place, const TileCells& cells,
                         const LaneGradient& own, const double* averages, std::size_t first_cell) {
    if constexpr (Straining::waits && !Tile::marked) {
      const V average = by.template average_of<false>(place, cells, averages, first_cell);
      if (HWY_LIKELY(waits_)) take(by);
      place_ = cells.place[0] - by.first;
      point_ = t.first;
      own_ = own;
      average_ = average;
      waits_ = true;
    } else {
      by.tile(t, place, cells, own, averages, first_cell);
    }
  }
  template <class Straining>
  HWY_NOINLINE void end(const Straining& by) const {
    if (waits_) take(by);
  }

 private:
  template <class Straining>
  HWY_INLINE void take(const Straining& by) const {
    by.strain(FullTile{point_}, place_, group_lanes, own_, own_, average_);
  }
  bool waits_ = false;
  std::uint32_t place_, point_;
  LaneGradient own_;
  V average_;
};

// `round`: axisymmetric, with the hoop's strain (PointView::hoop).
template <class S, bool round = false>
struct Straining {
  static constexpr bool waits = S::centred && !round;
  const StrainJob job;
  const PointView p;
  const CellView c;
  const StrainIncrements out;
  std::uint32_t first;  // place in `order` of the first increment
  double sx = job.dt * c.per_hx, sy = job.dt * c.per_hy;

  // To the increments of a tile's points; the next tile overwrites what goes beyond a group's last point.
  static HWY_INLINE void put(const FullTile&, V v, double* to, std::size_t) { hn::StoreU(v, D(), to); }
  template <class Tile>
  static HWY_INLINE void put(const Tile& t, V v, double* to, [[maybe_unused]] std::size_t second) {
    v = t.packed(v);
    if constexpr (groups == 2) put_groups(D(), v, to, second);
    else hn::StoreU(v, D(), to);
  }
  template <class Tag>
  static HWY_INLINE void put_groups(Tag d, V v, double* to, std::size_t second) {
    const hn::Half<Tag> h;
    hn::StoreU(hn::LowerHalf(h, v), h, to);
    hn::StoreU(hn::UpperHalf(h, v), h, to + second);
  }

  // The gradient of the step's displacement at a tile's points.
  template <class Tile>
  HWY_INLINE LaneGradient gradient_of(const Tile& t, const Natural& at, const TileCells& cells) const {
    const StrainVelocityAt<Tile::marked> u(c, cells);
    if constexpr (CellPolynomials::are_of<S>)
      if (!Tile::marked || CellPolynomials::hold(cells))
        return of_own(t, gradient(CellPolynomials(u, cells), at, sx, sy));
    return of_own(t, gradient(TileLines<S, Tile>(p, c, cells, t, at), c, cells, sx, sy));
  }
  // The volumetric strain that averages give a tile's points.
  template <bool marked>
  HWY_INLINE V average_of(const Natural& place, const TileCells& cells, const double* averages,
                          std::size_t first_cell) const {
    if (job.locking == Locking::none) return zero();
    if constexpr (S::centred) return averaged(c, cells, place.xi, place.eta);
    if (job.locking == Locking::fbar)
      return of_groups(averages[cells.occupied[0] - first_cell], averages[cells.occupied[groups - 1] - first_cell]);
    return lane_log_det(centre_gradient<marked>(c, cells, sx, sy));
  }
  template <class Tile>
  HWY_INLINE void tile(const Tile& t, const Natural& place, const TileCells& cells, const LaneGradient& own,
                       const double* averages, std::size_t first_cell) const {
    LaneGradient G = own;
    if constexpr (!S::centred)
      if (job.locking == Locking::full) G = centre_gradient<Tile::marked>(c, cells, sx, sy);
    strain(t, cells.place[0] - first, cells.place[groups - 1] - cells.place[0], own, G,
           average_of<Tile::marked>(place, cells, averages, first_cell));
  }

  // By a gradient G; `own` is that of the step's displacement.
  template <class Tile>
  HWY_INLINE void strain(const Tile& t, std::size_t at, std::size_t second, const LaneGradient& own,
                         const LaneGradient& G, V average) const {
    const V change = det_change(G);
    const LanePolar e = lane_polar(G, change);
    const V mean = set(0.5) * e.trace;
    V shift = zero(), theta = zero(), trace = e.trace;
    [[maybe_unused]] V hoop = zero();
    if constexpr (round) {
      hoop = t.own(t.load(p.hoop));
      trace = trace + hoop;
    }
    if (job.locking != Locking::none) {
      theta = job.locking == Locking::full ? e.trace : average;
      if (S::centred || job.locking == Locking::fbar) theta = hn::IfThenElse(stands_open(p, t), trace, theta);
      theta = t.own(theta);
      shift = (theta - trace) * set(1.0 / 3);
    }
    put(t, mean + e.half + shift, out.xx + at, second);
    put(t, mean - e.half + shift, out.yy + at, second);
    if constexpr (round) put(t, hoop + shift, out.zz + at, second);
    else put(t, shift, out.zz + at, second);
    put(t, e.xy, out.xy + at, second);
    put(t, e.spin, out.spin + at, second);
    if (!job.record) return;
    const V F_xx = t.load(p.F_xx), F_xy = t.load(p.F_xy), F_yx = t.load(p.F_yx), F_yy = t.load(p.F_yy);
    t.store(F_xx + hn::MulAdd(own.xx, F_xx, own.xy * F_yx), p.F_xx);
    t.store(F_xy + hn::MulAdd(own.xx, F_xy, own.xy * F_yy), p.F_xy);
    t.store(F_yx + hn::MulAdd(own.yx, F_xx, own.yy * F_yx), p.F_yx);
    t.store(F_yy + hn::MulAdd(own.yx, F_xy, own.yy * F_yy), p.F_yy);
    const V J = t.load(p.J);
    V grown = job.locking == Locking::none ? hn::MulAdd(J, change, J) : J * lane_exp(theta);
    if constexpr (round)
      if (job.locking == Locking::none) grown = grown * lane_exp(hoop);
    t.store(grown, p.J);
  }

  // Bilinear F-bar: the elements' means of ln det f, weights V0.
  HWY_INLINE void average_elements(Range range, double* averages) const {
    double sum[most_elements] = {}, volume[most_elements] = {};
    for_tiles(c, range, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
      const auto l = lines_of<S>(p, c, cells, t, job.where, job.dt);
      const V v = joined_volume(p, t);
      double s[groups], w[groups];
      group_sums(v * dilation<round>(p, t, l, c, cells, sx, sy), s);
      group_sums(v, w);
      for (std::size_t g = 0; g < groups; ++g) {
        sum[cells.occupied[g] - range.begin] += s[g];
        volume[cells.occupied[g] - range.begin] += w[g];
      }
    });
    for (std::size_t s = 0; s < range.end - range.begin; ++s) averages[s] = volume[s] > 0 ? sum[s] / volume[s] : 0;
  }

  HWY_INLINE std::size_t run(Range range, std::uint32_t* suspects) const {
    std::size_t found = 0;
    WaitingStrain waiting;
    double averages[most_elements];
    const bool average = !S::centred && job.locking == Locking::fbar;
    const std::size_t each = average ? most_elements : range.end - range.begin;
    while (range.begin < range.end) {
      const Range part{range.begin, std::min(range.end, range.begin + each)};
      if constexpr (!S::centred)
        if (average) average_elements(part, averages);
      for_tiles(c, part, [&](const auto& t, const TileCells& cells) PIVNP_TILE {
        const Natural at = natural<S>(p, c, cells, t, job.where, job.dt);
        waiting.strain(*this, t, at, cells, gradient_of(t, at, cells), averages, part.begin);
        if (suspects)
          find_suspects(c, cells, t, natural_of(c, cells, t.again(p.x), t.again(p.y)), suspects, found);
      });
      range.begin = part.end;
    }
    waiting.end(*this);
    return found;
  }
};

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

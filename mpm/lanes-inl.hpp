// Tiles, shape functions and sums in lanes: what the kernels (lanes.hpp) share. Included by their sources inside
// Highway's loop over instruction sets.
#if defined(PIVNP_MPM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_LANES_INL
#undef PIVNP_MPM_LANES_INL
#else
#define PIVNP_MPM_LANES_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "mpm/lanes.hpp"
#include "mpm/shape.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr std::size_t n_lanes = hn::MaxLanes(D());
// The lanes come in groups, each of one cell: at four points a cell more lanes than that would stay empty.
constexpr std::size_t group_lanes = n_lanes < 4 ? n_lanes : 4, groups = n_lanes / group_lanes;
static_assert(groups == 1 || groups == 2);

HWY_INLINE V set(double v) { return hn::Set(D(), v); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

// One number of each group in its lanes.
HWY_INLINE V of_groups(double first, [[maybe_unused]] double second) {
  if constexpr (groups == 1) return set(first);
  else return hn::IfThenElse(hn::FirstN(D(), group_lanes), set(first), set(second));
}
// The sum over each group's lanes, in one order whatever their number.
HWY_INLINE void group_sums(V v, double* out) {
  HWY_ALIGN double lane[n_lanes];
  hn::Store(v, D(), lane);
  for (std::size_t g = 0; g < groups; ++g) {
    const double* of = lane + g * group_lanes;
    if constexpr (group_lanes == 4) out[g] = (of[0] + of[1]) + (of[2] + of[3]);
    else if constexpr (group_lanes == 2) out[g] = of[0] + of[1];
    else out[g] = of[0];
  }
}

// Of what is done with a tile: inline, or the arrays' addresses would be looked up again after every store.
#undef PIVNP_TILE
#define PIVNP_TILE HWY_ATTR __attribute__((always_inline))

// Points that lie together, one to every lane, of cells beside no wall.
struct FullTile {
  static constexpr bool beside_walls = false;
  std::uint32_t first;
  HWY_INLINE V load(const double* a) const {
    hwy::Prefetch(a + first + 96);
    return hn::LoadU(D(), a + first);
  }
  HWY_INLINE void store(V v, double* a) const { hn::StoreU(v, D(), a + first); }
  HWY_INLINE V live(V v) const { return v; }
};

// Groups whose points lie together each. The lanes that are left read what comes behind, and are not stored. They may
// stand where the cell has no material and its nodes any velocity: no mass of theirs makes up for what is not a number.
struct GroupTile {
  static constexpr bool beside_walls = true;
  std::uint32_t first[groups], size[groups];

  HWY_INLINE V load(const double* a) const { return loaded(D(), a); }
  HWY_INLINE void store(V v, double* a) const { put(D(), v, a); }
  HWY_INLINE V live(V v) const { return hn::IfThenElseZero(mask(D()), v); }

 private:
  template <class Tag>
  HWY_INLINE M mask(Tag d) const {
    if constexpr (groups == 1) {
      return hn::FirstN(d, size[0]);
    } else {
      const std::uint8_t bits[8] = {std::uint8_t(((1u << size[0]) - 1) | ((1u << size[groups - 1]) - 1) << group_lanes)};
      return hn::LoadMaskBits(d, bits);
    }
  }
  template <class Tag>
  HWY_INLINE V loaded(Tag d, const double* a) const {
    hwy::Prefetch(a + first[0] + 96);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (groups == 2) {
      const hn::Half<Tag> h;
      return hn::Combine(d, hn::LoadU(h, a + first[groups - 1]), hn::LoadU(h, a + first[0]));
    }
#endif
    return hn::LoadU(d, a + first[0]);
  }
  template <class Tag>
  HWY_INLINE void put(Tag d, V v, double* a) const {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (groups == 2) {
      const hn::Half<Tag> h;
      hn::BlendedStore(hn::LowerHalf(h, v), hn::FirstN(h, size[0]), h, a + first[0]);
      hn::BlendedStore(hn::UpperHalf(h, v), hn::FirstN(h, size[groups - 1]), h, a + first[groups - 1]);
      return;
    }
#endif
    // (With two lanes some processors would write the other one back, to which another thread may write.)
    if (n_lanes == 2 && size[0] == 1) a[first[0]] = hn::GetLane(v);
    else hn::BlendedStore(v, hn::FirstN(d, size[0]), d, a + first[0]);
  }
};

// Points anywhere. The lanes that are left repeat a point of their group's cell, and get what it gets.
struct PartTile {
  static constexpr bool beside_walls = true;
  std::uint32_t point[n_lanes];
  std::uint8_t is_live[8] = {};  // a bit a lane

  HWY_INLINE PartTile(const std::uint32_t* order, std::size_t n) { take(0, order, n, n_lanes); }
  // Of each group `size` points from `place` of the order on.
  HWY_INLINE PartTile(const std::uint32_t* order, const std::uint32_t* place, const std::uint32_t* size) {
    for (std::size_t g = 0; g < groups; ++g) take(g * group_lanes, order + place[g] - (size[g] == 0), size[g], group_lanes);
  }
  HWY_INLINE V load(const double* a) const { return gathered(D(), a); }
  HWY_INLINE void store(V v, double* a) const {
    HWY_ALIGN double lane[n_lanes];
    hn::Store(v, D(), lane);
    for (std::size_t l = 0; l < n_lanes; ++l) a[point[l]] = lane[l];
  }
  HWY_INLINE V live(V v) const { return hn::IfThenElseZero(hn::LoadMaskBits(D(), is_live), v); }

 private:
  // `n` points to the `room` lanes from `lane` on.
  HWY_INLINE void take(std::size_t lane, const std::uint32_t* order, std::size_t n, std::size_t room) {
    std::uint32_t k = order[0];
    for (std::size_t l = 0; l < room; ++l) point[lane + l] = k = l < n ? order[l] : k;
    is_live[0] = std::uint8_t(is_live[0] | ((1u << n) - 1) << lane);
  }
  template <class Tag>
  HWY_INLINE V gathered(Tag d, const double* a) const {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(d, a[point[0]]);
#else
    return from(d, a, 0);
#endif
  }
#if HWY_TARGET != HWY_SCALAR
  template <class Tag>
  HWY_INLINE hn::Vec<Tag> from(Tag d, const double* a, std::size_t lane) const {
    if constexpr (hn::MaxLanes(Tag()) == 2) {
      return hn::OddEven(hn::Set(d, a[point[lane + 1]]), hn::Set(d, a[point[lane]]));
    } else {
      const hn::Half<Tag> h;
      return hn::Combine(d, from(h, a, lane + hn::MaxLanes(h)), from(h, a, lane));
    }
  }
#endif
};

// The cells of a tile's groups.
struct TileCells {
  Node* base[groups];           // the lower left node of the stencil
  std::size_t slot[groups];
  std::uint32_t place[groups];  // of the group's first point in `order`
  unsigned fold[groups];        // walls
  std::ptrdiff_t nx;            // nodes in a row

  HWY_INLINE unsigned any_fold() const { return fold[0] | fold[groups - 1]; }
  /// The lanes with one of these walls.
  HWY_INLINE M beside(unsigned walls) const {
    return hn::Gt(of_groups(fold[0] & walls ? 1 : 0, fold[groups - 1] & walls ? 1 : 0), zero());
  }
  /// A member of the node `n` behind `base`.
  HWY_INLINE V value(std::ptrdiff_t n, double Node::*member) const {
    return of_groups(base[0][n].*member, base[groups - 1][n].*member);
  }
};

// Calls body(tile, cells) for the points of some slots.
template <class Body>
HWY_INLINE void for_tiles(const CellView& c, SlotRange slots, Body&& body) {
  std::size_t s = slots.begin;
  if (s == slots.end) return;
  TileCells cells;
  cells.nx = c.nx;
  std::uint32_t q = c.slot_begin[s];
  GroupTile t;
  bool together = true, full = true;  // does each group lie together, and all of them, with no lane left?
  const auto take = [&](std::size_t g) PIVNP_TILE {
    const std::uint32_t left = c.slot_begin[s + 1] - q, n = left < group_lanes ? left : std::uint32_t(group_lanes);
    cells.base[g] = c.node + c.slot_cell[s];
    cells.slot[g] = s;
    cells.place[g] = q;
    cells.fold[g] = c.slot_fold[s];
    t.first[g] = c.order[q];
    t.size[g] = n;
    together = together && c.order[q + n - 1] == t.first[g] + (n - 1);
    full = full && n == group_lanes;
    q += n;
    s += n == left;
  };
  while (s < slots.end) {
    together = full = true;
    take(0);
    if constexpr (groups == 2) {
      if (HWY_LIKELY(s < slots.end)) {
        take(1);
        full = full && t.first[1] == t.first[0] + group_lanes;
      } else {  // the first cell once more, with no points
        cells.base[1] = cells.base[0];
        cells.slot[1] = cells.slot[0];
        cells.place[1] = cells.place[0] + t.size[0];
        cells.fold[1] = cells.fold[0];
        t.first[1] = t.first[0];
        t.size[1] = 0;
        full = false;
      }
    }
    if (HWY_LIKELY(together && full && cells.any_fold() == 0)) body(FullTile{t.first[0]}, cells);
    else if (together && t.first[0] + group_lanes <= c.points && t.first[groups - 1] + group_lanes <= c.points) body(t, cells);
    else body(PartTile(c.order, cells.place, t.size), cells);
  }
}

// Shape functions as in shape.hpp.
template <int width>
struct LaneLine {
  V w[width], g[width];
};

struct BilinearLanes {
  static constexpr int W = 2, first = 0;
  static constexpr bool linear = true, needs_size = false;
  static HWY_INLINE LaneLine<2> line(V xi, V) { return {{set(1) - xi, xi}, {set(-1), set(1)}}; }
  static HWY_INLINE LaneLine<2> line_at_wall(V xi, V half, bool) { return line(xi, half); }
  static HWY_INLINE V per_moment(const LaneLine<2>&, const V*) { return zero(); }
};

struct BSplineLanes {
  static constexpr int W = 3, first = -1;
  static constexpr bool linear = false, needs_size = false;
  static HWY_INLINE LaneLine<3> line(V xi, V) {
    const V a = set(0.5) - xi, b = set(0.5) + xi;
    return {{set(0.5) * a * a, hn::NegMulAdd(xi, xi, set(0.75)), set(0.5) * b * b},
            {hn::Neg(a), set(-2) * xi, b}};
  }
  static HWY_INLINE LaneLine<3> line_at_wall(V xi, V, bool low) {
    const V one = set(1);
    if (low) {
      xi = hn::Max(xi, zero());
      return {{zero(), one - xi, xi}, {zero(), set(-1), one}};
    }
    xi = hn::Min(xi, zero());
    return {{hn::Neg(xi), one + xi, zero()}, {set(-1), one, zero()}};
  }
  static HWY_INLINE V per_moment(const LaneLine<3>&, const V*) { return set(4); }
};

struct GimpLanes {
  static constexpr int W = 3, first = -1;
  static constexpr bool linear = false, needs_size = true;
  static HWY_INLINE LaneLine<3> line(V xi, V half) {
    const V one = set(1), per = one / half;
    LaneLine<3> out;
    for (int a = 0; a < 3; ++a) {
      const V x = xi - set(a - 1), d = hn::Abs(x);
      const M near = hn::Lt(d, half), middle = hn::Le(d, one - half), reached = hn::Lt(d, one + half);
      const V left = one + half - d, quarter = set(0.25) * per, sign = hn::CopySign(one, x);
      out.w[a] = hn::IfThenElse(
          near, one - (d * d + half * half) * (set(0.5) * per),
          hn::IfThenElse(middle, one - d, hn::IfThenElseZero(reached, left * left * quarter)));
      out.g[a] = hn::IfThenElse(near, hn::Neg(x) * per,
                                hn::IfThenElse(middle, hn::Neg(sign),
                                               hn::IfThenElseZero(reached, hn::Neg(sign) * left * (set(0.5) * per))));
    }
    return out;
  }
  static HWY_INLINE LaneLine<3> line_at_wall(V xi, V half, bool low) {
    LaneLine<3> out = line(low ? hn::Max(xi, zero()) : hn::Min(xi, zero()), half);
    const int behind = low ? 0 : 2, ahead = low ? 2 : 0;
    out.w[1] = hn::MulAdd(set(2), out.w[behind], out.w[1]);
    out.g[1] = hn::MulAdd(set(2), out.g[behind], out.g[1]);
    out.w[ahead] = out.w[ahead] - out.w[behind];
    out.g[ahead] = out.g[ahead] - out.g[behind];
    out.w[behind] = out.g[behind] = zero();
    return out;
  }
  static HWY_INLINE V per_moment(const LaneLine<3>& l, const V* arm) {
    return set(1) / (l.w[0] * arm[0] * arm[0] + l.w[1] * arm[1] * arm[1] + l.w[2] * arm[2] * arm[2]);
  }
};

// What F-bar averages over: V0 of the points that material connects; one that stands open keeps its own.
template <class Tile>
HWY_INLINE M stands_open(const PointView& p, const Tile& t) {
  return hn::Gt(t.load(p.gap), zero());
}
template <class Tile>
HWY_INLINE V joined_volume(const PointView& p, const Tile& t) {
  return hn::IfThenZeroElse(stands_open(p, t), t.live(t.load(p.volume0)));
}

// The functions of a tile's points along both axes.
template <class S, class Tile>
struct TileLines {
  using Shape = S;
  static constexpr int W = S::W;
  static constexpr bool beside_walls = !S::linear && Tile::beside_walls;
  V xi, eta;
  LaneLine<S::W> x, y;

  HWY_INLINE TileLines(const PointView& p, const TileCells& cells, const Tile& t) : xi(t.load(p.xi)), eta(t.load(p.eta)) {
    V half = zero();
    if constexpr (S::needs_size) half = t.load(p.half);
    x = S::line(xi, half);
    y = S::line(eta, half);
    if constexpr (beside_walls) {
      at_wall(cells, xi, half, fold_left, fold_right, x);
      at_wall(cells, eta, half, fold_down, fold_up, y);
    }
  }
  // Distances of the nodes from the points, in cells.
  HWY_INLINE void arms(V* ax, V* ay) const {
    for (int a = 0; a < S::W; ++a) {
      ax[a] = set(a + S::first) - xi;
      ay[a] = set(a + S::first) - eta;
    }
  }

 private:
  static HWY_INLINE void at_wall(const TileCells& cells, V place, V half, unsigned low, unsigned high, LaneLine<S::W>& line) {
    for (const unsigned wall : {low, high}) {
      if (!(cells.any_fold() & wall)) continue;
      const M beside = cells.beside(wall);
      const LaneLine<S::W> other = S::line_at_wall(place, half, wall == low);
      for (int a = 0; a < S::W; ++a) {
        line.w[a] = hn::IfThenElse(beside, other.w[a], line.w[a]);
        line.g[a] = hn::IfThenElse(beside, other.g[a], line.g[a]);
      }
    }
  }
};

template <class S, class Tile>
HWY_INLINE TileLines<S, Tile> lines_of(const PointView& p, const TileCells& cells, const Tile& t) {
  return {p, cells, t};
}

// The hats of a cell's corners (averages.hpp).
HWY_INLINE void hat_lanes(V xi, V* w) {
  w[0] = set(0.5) - xi;
  w[1] = set(0.5) + xi;
}

// sum over a line of weight times a member of the row's nodes, the first of which is `row` behind the base.
template <int W>
HWY_INLINE V row_sum(const V* w, const TileCells& cells, std::ptrdiff_t row, double Node::*member) {
  V sum = w[0] * cells.value(row, member);
  for (int a = 1; a < W; ++a) sum = hn::MulAdd(w[a], cells.value(row + a, member), sum);
  return sum;
}
template <int W>
HWY_INLINE V dot(const V* w, const V* v) {
  V sum = w[0] * v[0];
  for (int a = 1; a < W; ++a) sum = hn::MulAdd(w[a], v[a], sum);
  return sum;
}

// The sums over each group's lanes of four vectors, added to memory. (Templates, so that only the branch of the lanes
// compiles.)
struct Four {
  V a, b, c, e;

  /// To four numbers in a row at first(group), aligned.
  template <class First>
  HWY_INLINE void add_to(First&& first) const {
    add(D(), first);
  }
  /// To two at low(group) and two at high(group).
  template <class Low, class High>
  HWY_INLINE void add_to(Low&& low, High&& high) const {
    add_halves(D(), low, high);
  }
  /// To single ones at each(group, number).
  template <class Each>
  HWY_INLINE void add_singly(Each&& each) const {
    HWY_ALIGN double sums[groups][4] = {};
    add(D(), [&](std::size_t g) PIVNP_TILE { return sums[g]; });
    for (std::size_t g = 0; g < groups; ++g)
      for (std::size_t n = 0; n < 4; ++n) *each(g, n) += sums[g][n];
  }

 private:
#if HWY_TARGET == HWY_SCALAR
  template <class First>
  HWY_INLINE void add(D d, First&& first) const {
    add_halves(d, first, [&](std::size_t g) { return first(g) + 2; });
  }
  template <class Low, class High>
  HWY_INLINE void add_halves(D, Low&& low, High&& high) const {
    low(0)[0] += hn::GetLane(a);
    low(0)[1] += hn::GetLane(b);
    high(0)[0] += hn::GetLane(c);
    high(0)[1] += hn::GetLane(e);
  }
#else
  template <class Tag>
  static HWY_INLINE V pairs(Tag d, V x, V y) {
    return hn::InterleaveLower(d, x, y) + hn::InterleaveUpper(d, x, y);
  }
  // a, b, c, e of the first group, then of the second.
  template <class Tag>
  HWY_INLINE V all(Tag d) const {
    const V ab = pairs(d, a, b), ce = pairs(d, c, e);
    if constexpr (groups == 1) return hn::ConcatLowerLower(d, ce, ab) + hn::ConcatUpperUpper(d, ce, ab);
    else return hn::OddEvenBlocks(ce, ab) + hn::SwapAdjacentBlocks(hn::OddEvenBlocks(ab, ce));
  }
  template <class Tag>
  static HWY_INLINE void add_at(Tag d, hn::Vec<Tag> v, double* at) {
    hn::StoreU(hn::LoadU(d, at) + v, d, at);
  }
  template <class Tag, class First>
  HWY_INLINE void add(Tag d, First&& first) const {
    if constexpr (n_lanes == 8) {
      const hn::Half<Tag> h;
      const V sums = all(d);
      add_at(h, hn::LowerHalf(h, sums), first(0));
      add_at(h, hn::UpperHalf(h, sums), first(1));
    } else if constexpr (n_lanes == 4) {
      add_at(d, all(d), first(0));
    } else {
      add_halves(d, first, [&](std::size_t g) PIVNP_TILE { return first(g) + 2; });
    }
  }
  template <class Tag, class Low, class High>
  HWY_INLINE void add_halves(Tag d, Low&& low, High&& high) const {
    if constexpr (n_lanes == 8) {
      const hn::Half<Tag> h;
      const V sums = all(d);
      split(h, hn::LowerHalf(h, sums), low(0), high(0));
      split(h, hn::UpperHalf(h, sums), low(1), high(1));
    } else if constexpr (n_lanes == 4) {
      split(d, all(d), low(0), high(0));
    } else {
      add_at(d, pairs(d, a, b), low(0));
      add_at(d, pairs(d, c, e), high(0));
    }
  }
  template <class Tag>
  static HWY_INLINE void split(Tag d, hn::Vec<Tag> v, double* low, double* high) {
    const hn::Half<Tag> h;
    add_at(h, hn::LowerHalf(h, v), low);
    add_at(h, hn::UpperHalf(h, v), high);
  }
#endif
};

// Adds the sums over each group's lanes of a[c], b[c] to two numbers of each of a stencil's nodes; at(group, c) is the
// first.
template <int N, class At>
HWY_INLINE void add_pairs(const V* a, const V* b, At&& at) {
  for (int c = 0; c + 1 < N; c += 2)
    Four{a[c], b[c], a[c + 1], b[c + 1]}.add_to([&](std::size_t g) PIVNP_TILE { return at(g, c); },
                                                [&](std::size_t g) PIVNP_TILE { return at(g, c + 1); });
  if constexpr (N % 2 == 1) {
    double sums[2][groups];
    group_sums(a[N - 1], sums[0]);
    group_sums(b[N - 1], sums[1]);
    for (std::size_t g = 0; g < groups; ++g) {
      at(g, N - 1)[0] += sums[0][g];
      at(g, N - 1)[1] += sums[1][g];
    }
  }
}

// F-bar of three-node shapes (averages.hpp): `a` by its weights v and the hats of a cell's corners; with `volumes` the
// weights and the cell's edges too.
HWY_INLINE void add_to_averages(const CellView& c, const TileCells& cells, bool volumes, V xi, V eta, V v, V a) {
  V hx[2], hy[2], value[4], volume[4];
  hat_lanes(xi, hx);
  hat_lanes(eta, hy);
  for (int n = 0; n < 4; ++n) {
    volume[n] = v * hx[n % 2] * hy[n / 2];
    value[n] = volume[n] * a;
  }
  std::ptrdiff_t cell[groups];
  for (std::size_t g = 0; g < groups; ++g) cell[g] = cells.base[g] - c.node;
  const auto corner = [&](std::size_t g, std::ptrdiff_t n) PIVNP_TILE {
    return &c.average.corners[cell[g] + n / 2 * cells.nx + n % 2].value;
  };
  if (volumes) {
    add_pairs<4>(value, volume, corner);
    Four{hx[0] * volume[1], hx[0] * volume[3], hy[0] * volume[2], hy[0] * volume[3]}.add_to(
        [&](std::size_t g) PIVNP_TILE { return &c.average.edges[cell[g]].low; });
  } else {
    Four{value[0], value[1], value[2], value[3]}.add_singly(
        [&](std::size_t g, std::size_t n) PIVNP_TILE { return corner(g, std::ptrdiff_t(n)); });
  }
}
// The average at the points.
HWY_INLINE V averaged(const CellView& c, const TileCells& cells, V xi, V eta) {
  V hx[2], hy[2];
  hat_lanes(xi, hx);
  hat_lanes(eta, hy);
  const double *first = c.average.mean + (cells.base[0] - c.node), *second = c.average.mean + (cells.base[groups - 1] - c.node);
  const auto at = [&](std::ptrdiff_t n) PIVNP_TILE { return of_groups(first[n], second[n]); };
  const V low = hn::MulAdd(hx[1], at(1), hx[0] * at(0)), high = hn::MulAdd(hx[1], at(cells.nx + 1), hx[0] * at(cells.nx));
  return hn::MulAdd(hy[1], high, hy[0] * low);
}

/// Calls action with the lane form of the shape.
template <class Action>
HWY_INLINE auto with_lanes(ShapeKind kind, Action&& action) {
  switch (kind) {
    case ShapeKind::bilinear: return action(BilinearLanes{});
    case ShapeKind::gimp: return action(GimpLanes{});
    default: return action(BSplineLanes{});
  }
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// Shape functions in lanes, and where a tile's points are: what the kernels (lanes.hpp) share. Included by their sources inside
// Highway's loop over instruction sets.
#if defined(PIVNP_MPM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_LANES_INL
#undef PIVNP_MPM_LANES_INL
#else
#define PIVNP_MPM_LANES_INL
#endif

#include "mpm/grid/shape.hpp"
#include "mpm/simd/sums-inl.hpp"
#include "mpm/transfer/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Shape functions in lanes (shape_functions.hpp).
template <class T>
HWY_INLINE T constant(double value) {
  return set(value);
}
#define PIVNP_NUMBERS HWY_INLINE
#define PIVNP_NUMBERS_LAMBDA PIVNP_TILE
#include "mpm/grid/shape_functions.hpp"
#undef PIVNP_NUMBERS
#undef PIVNP_NUMBERS_LAMBDA

// Where all are of one body, of its density.
template <class Tile>
HWY_INLINE V mass_of(const PointView& p, const Tile& t) {
  return t.live(p.mass ? t.load(p.mass) : set(p.density) * t.load(p.volume0));
}

// What F-bar averages over: V0 of the points that material connects; one that stands open keeps its own.
template <class Tile>
HWY_INLINE M stands_open(const PointView& p, const Tile& t) {
  if (!p.opening) return hn::FirstN(D(), 0);  // no law opens
  return hn::Gt(t.load(p.opening), zero());
}
template <class Tile>
HWY_INLINE V joined_volume(const PointView& p, const Tile& t) {
  return hn::IfThenZeroElse(stands_open(p, t), t.live(t.load(p.volume0)));
}

// Natural coordinates (shape.hpp).
struct Natural {
  V xi, eta;
};
// Those of the places x, y in the tile's cells.
HWY_INLINE Natural natural_of(const CellView& c, const TileCells& cells, V x, V y) {
  return {hn::MulSub(x - set(c.origin_x), set(c.per_hx), of_groups(cells.i[0], cells.i[groups - 1])),
          hn::MulSub(y - set(c.origin_y), set(c.per_hy), of_groups(cells.j[0], cells.j[groups - 1]))};
}
// Where the square around a node begins and ends in a row of n nodes: at the node on the domain's edge.
HWY_INLINE V begins(const double* at) { return of_groups(at[0] == 1 ? 0 : -0.5, at[groups - 1] == 1 ? 0 : -0.5); }
HWY_INLINE V ends(const double* at, int n) { return of_groups(at[0] == n - 2 ? 0 : 0.5, at[groups - 1] == n - 2 ? 0 : 0.5); }
// Appends the places in `order` of the points that are outside their cell. Beyond the domain's edge is outside too.
template <class Tile>
HWY_INLINE void find_suspects(const CellView& c, const TileCells& cells, const Tile& t, const Natural& at, std::uint32_t* suspects,
                              std::size_t& found) {
  const D d;
  const V low = set(c.origin == 0 ? 0 : -0.5), high = set(c.origin == 0 ? 1 : 0.5);
  M inside = hn::And(hn::And(hn::Ge(at.xi, low), hn::Lt(at.xi, high)), hn::And(hn::Ge(at.eta, low), hn::Lt(at.eta, high)));
  if constexpr (Tile::marked)
    if (cells.any_mark() & at_edge)
      inside = hn::And(inside, hn::And(hn::And(hn::Ge(at.xi, begins(cells.i)), hn::Lt(at.xi, ends(cells.i, c.nx))),
                                       hn::And(hn::Ge(at.eta, begins(cells.j)), hn::Lt(at.eta, ends(cells.j, c.ny)))));
  const V outside = t.live(hn::IfThenElse(inside, zero(), set(1)));
  if (HWY_LIKELY(hn::AllTrue(d, hn::Eq(outside, zero())))) return;
  HWY_ALIGN double out[n_lanes];
  hn::Store(outside, d, out);
  for (std::size_t l = 0; l < n_lanes; ++l)
    if (out[l] != 0) suspects[found++] = cells.place[l / group_lanes] + t.rank(l / group_lanes, l % group_lanes);
}

// Where a tile's points are, or were; lanes without a point are somewhere in the cell.
template <class S, class Tile>
HWY_INLINE Natural natural(const PointView& p, const CellView& c, const TileCells& cells, const Tile& t, Where where = Where::now,
                           double dt = 0) {
  if (where == Where::kept) return {t.load(p.xi), t.load(p.eta)};
  V x = t.load(p.x), y = t.load(p.y);
  if (where == Where::before) {
    x = hn::NegMulAdd(set(dt), t.load(p.vx), x);
    y = hn::NegMulAdd(set(dt), t.load(p.vy), y);
  }
  const Natural at = natural_of(c, cells, x, y);
  if constexpr (!Tile::marked) return at;
  const V low = set(S::centred ? -0.5 : 0), high = set(S::centred ? 0.5 : 1);
  return {hn::Min(hn::Max(at.xi, low), high), hn::Min(hn::Max(at.eta, low), high)};
}

// The functions of a tile's points along both axes.
template <class S, class Tile>
struct TileLines {
  using Shape = S;
  static constexpr int W = S::width;
  static constexpr bool marked = Tile::marked, beside_walls = S::centred && marked;
  V xi, eta;
  Line<V, S::width> x, y;
  bool moved = false;  // any of the nodes onto a wall, by these, in cells
  V shift_x[W], shift_y[W];
  M by_slope[2];  // lanes where one is moved along x, y

  HWY_INLINE TileLines(const PointView& p, const CellView& c, const TileCells& cells, const Tile& t, const Natural& at)
      : xi(at.xi), eta(at.eta) {
    V half = zero();
    if constexpr (S::needs_size) half = t.load(p.half);
    x = S::line(xi, half);
    y = S::line(eta, half);
    if constexpr (beside_walls) {
      moved = cells.any_mark() & wall_moved;
      along(c, cells, xi, half, 0, wall_left, x, shift_x);
      along(c, cells, eta, half, 1, wall_down, y, shift_y);
    }
  }
  // Distances of the nodes from the points, in cells.
  HWY_INLINE void arms(V* ax, V* ay) const {
    for (int a = 0; a < S::width; ++a) {
      ax[a] = set(a + S::first) - xi;
      ay[a] = set(a + S::first) - eta;
    }
    if constexpr (beside_walls)
      for (int a = 0; a < S::width && moved; ++a) {
        ax[a] = ax[a] + shift_x[a];
        ay[a] = ay[a] + shift_y[a];
      }
  }

 private:
  // By the walls at both ends of an axis; the mark of the one at its high end is twice that of the one at its low end.
  HWY_INLINE void along(const CellView& c, const TileCells& cells, V place, V half, int axis, unsigned mark,
                        Line<V, W>& line, V* shift) {
    const MovedNodes* by[groups] = {};
    if (moved) {
      for (std::size_t g = 0; g < groups; ++g) by[g] = c.moved + (cells.base[g] - c.node);
      for (int a = 0; a < W; ++a) shift[a] = zero();
      by_slope[axis] = hn::FirstN(D(), 0);
    }
    for (const bool low : {true, false}) {
      const unsigned wall = low ? mark : 2 * mark;
      V s = zero();
      if (moved) {
        const auto& first = low ? by[0]->low : by[0]->high;
        const auto& second = low ? by[groups - 1]->low : by[groups - 1]->high;
        s = of_groups(first[axis], second[axis]);
      }
      if (!moved && !(cells.any_mark() & wall)) continue;
      const M beside = cells.beside(wall);
      if (cells.any_mark() & wall) {
        const Line<V, W> other = S::line_at_wall(place, half, low, s);
        for (int a = 0; a < W; ++a) {
          line.w[a] = hn::IfThenElse(beside, other.w[a], line.w[a]);
          line.g[a] = hn::IfThenElse(beside, other.g[a], line.g[a]);
        }
      }
      if (!moved) continue;
      const V e = s / (set(1) - s), inwards = low ? s : hn::Neg(s);
      const int end = low ? 0 : W - 1;
      move_node(line, 1, low ? 2 : 0, hn::IfThenElseZero(beside, e));
      move_node(line, end, 1, hn::IfThenZeroElse(beside, e));
      shift[1] = shift[1] + hn::IfThenElseZero(beside, inwards);
      shift[end] = shift[end] + hn::IfThenZeroElse(beside, inwards);
      by_slope[axis] = hn::Or(by_slope[axis], hn::Ne(s, zero()));
    }
  }
};

template <class S, class Tile>
HWY_INLINE TileLines<S, Tile> lines_of(const PointView& p, const CellView& c, const TileCells& cells, const Tile& t,
                                       Where where = Where::now, double dt = 0) {
  return {p, c, cells, t, natural<S>(p, c, cells, t, where, dt)};
}

// Axisymmetric: the points' distances from the axis; of lanes without a point anything above zero.
HWY_INLINE V radius_of(const CellView& c, const TileCells& cells, V xi) {
  const V x = hn::MulAdd(xi + of_groups(cells.i[0], cells.i[groups - 1]), set(c.hx), set(c.origin_x));
  return hn::Max(x, set(1e-9 * c.hx));
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
  const CornerSums* first = c.average.corners + (cells.base[0] - c.node);
  const CornerSums* second = c.average.corners + (cells.base[groups - 1] - c.node);
  const auto at = [&](std::ptrdiff_t n) PIVNP_TILE { return of_groups(first[n].value, second[n].value); };
  const V low = hn::MulAdd(hx[1], at(1), hx[0] * at(0)), high = hn::MulAdd(hx[1], at(cells.nx + 1), hx[0] * at(cells.nx));
  return hn::MulAdd(hy[1], high, hy[0] * low);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

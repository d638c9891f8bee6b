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
using D = hn::CappedTag<double, 4>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr std::size_t n_lanes = hn::MaxLanes(D());
static_assert(n_lanes == 1 || n_lanes == 2 || n_lanes == 4);

HWY_INLINE V set(double v) { return hn::Set(D(), v); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

// Of what is done with a tile: inline, or the arrays' addresses would be looked up again after every store.
#undef PIVNP_TILE
#define PIVNP_TILE HWY_ATTR __attribute__((always_inline))

// Points that lie together, one to every lane.
struct FullTile {
  std::uint32_t first;
  HWY_INLINE V load(const double* a) const {
    hwy::Prefetch(a + first + 96);
    return hn::LoadU(D(), a + first);
  }
  HWY_INLINE void store(V v, double* a) const { hn::StoreU(v, D(), a + first); }
  HWY_INLINE V live(V v) const { return v; }
};

// Points anywhere; the last one repeated in the lanes that are left.
struct PartTile {
  std::uint32_t point[n_lanes];
  std::size_t size;

  HWY_INLINE PartTile(const std::uint32_t* order, std::size_t n) : size(n) {
    std::uint32_t last = order[0];
    for (std::size_t l = 0; l < n_lanes; ++l) {
      if (l < n) last = order[l];
      point[l] = last;
    }
  }
  HWY_INLINE V load(const double* a) const { return gathered(D(), a); }
  HWY_INLINE void store(V v, double* a) const {
    HWY_ALIGN double lane[n_lanes];
    hn::Store(v, D(), lane);
    for (std::size_t l = 0; l < size; ++l) a[point[l]] = lane[l];
  }
  HWY_INLINE V live(V v) const { return hn::IfThenElseZero(hn::FirstN(D(), size), v); }

 private:
  template <class Tag>
  HWY_INLINE V gathered(Tag d, const double* a) const {
#if HWY_TARGET == HWY_SCALAR
    return hn::Set(d, a[point[0]]);
#else
    if constexpr (n_lanes == 4) {
      const hn::Half<Tag> h;
      return hn::Combine(d, hn::OddEven(hn::Set(h, a[point[3]]), hn::Set(h, a[point[2]])),
                         hn::OddEven(hn::Set(h, a[point[1]]), hn::Set(h, a[point[0]])));
    } else {
      return hn::OddEven(hn::Set(d, a[point[1]]), hn::Set(d, a[point[0]]));
    }
#endif
  }
};

template <class Body>
HWY_INLINE void for_tiles(const CellView& c, std::size_t slot, Body&& body) {
  const std::uint32_t end = c.slot_begin[slot + 1];
  for (std::uint32_t q = c.slot_begin[slot]; q < end; q += n_lanes) {
    const std::uint32_t* order = c.order + q;
    if (end - q >= n_lanes && order[n_lanes - 1] == order[0] + (n_lanes - 1)) body(FullTile{order[0]});
    else body(PartTile(order, end - q < n_lanes ? end - q : n_lanes));
  }
}
// The same, with body(tile, its place in `order`).
template <class Body>
HWY_INLINE void for_placed_tiles(const CellView& c, std::size_t slot, Body&& body) {
  std::uint32_t q = c.slot_begin[slot];
  for_tiles(c, slot, [&](const auto& t) PIVNP_TILE {
    body(t, q);
    q += n_lanes;
  });
}

// Shape functions as in shape.hpp.
template <int width>
struct LaneLine {
  V w[width], g[width];
};

struct BilinearLanes {
  static constexpr int W = 2, first = 0;
  static constexpr bool linear = true, needs_size = false;
  static HWY_INLINE LaneLine<2> line(V xi, V, bool, bool) { return {{set(1) - xi, xi}, {set(-1), set(1)}}; }
  static HWY_INLINE V per_moment(const LaneLine<2>&, const V*) { return zero(); }
};

struct BSplineLanes {
  static constexpr int W = 3, first = -1;
  static constexpr bool linear = false, needs_size = false;
  static HWY_INLINE LaneLine<3> line(V xi, V, bool low, bool high) {
    const V one = set(1);
    if (HWY_UNLIKELY(low)) {
      xi = hn::Max(xi, zero());
      return {{zero(), one - xi, xi}, {zero(), set(-1), one}};
    }
    if (HWY_UNLIKELY(high)) {
      xi = hn::Min(xi, zero());
      return {{hn::Neg(xi), one + xi, zero()}, {set(-1), one, zero()}};
    }
    const V a = set(0.5) - xi, b = set(0.5) + xi;
    return {{set(0.5) * a * a, hn::NegMulAdd(xi, xi, set(0.75)), set(0.5) * b * b},
            {hn::Neg(a), set(-2) * xi, b}};
  }
  static HWY_INLINE V per_moment(const LaneLine<3>&, const V*) { return set(4); }
};

struct GimpLanes {
  static constexpr int W = 3, first = -1;
  static constexpr bool linear = false, needs_size = true;
  static HWY_INLINE LaneLine<3> line(V xi, V half, bool low, bool high) {
    const V one = set(1), per = one / half;
    if (low) xi = hn::Max(xi, zero());
    if (high) xi = hn::Min(xi, zero());
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
    if (low) fold(out, 0, 2);
    if (high) fold(out, 2, 0);
    return out;
  }
  static HWY_INLINE V per_moment(const LaneLine<3>& l, const V* arm) {
    return set(1) / (l.w[0] * arm[0] * arm[0] + l.w[1] * arm[1] * arm[1] + l.w[2] * arm[2] * arm[2]);
  }

 private:
  static HWY_INLINE void fold(LaneLine<3>& l, int behind, int ahead) {
    l.w[1] = hn::MulAdd(set(2), l.w[behind], l.w[1]);
    l.g[1] = hn::MulAdd(set(2), l.g[behind], l.g[1]);
    l.w[ahead] = l.w[ahead] - l.w[behind];
    l.g[ahead] = l.g[ahead] - l.g[behind];
    l.w[behind] = l.g[behind] = zero();
  }
};

// The functions of a tile's points along both axes.
// What F-bar averages over: V0 of the points that material connects; one that stands open keeps its own.
template <class Tile>
HWY_INLINE M stands_open(const PointView& p, const Tile& t) {
  return hn::Gt(t.load(p.gap), zero());
}
template <class Tile>
HWY_INLINE V joined_volume(const PointView& p, const Tile& t) {
  return hn::IfThenZeroElse(stands_open(p, t), t.live(t.load(p.volume0)));
}

template <class S>
struct TileLines {
  V xi, eta;
  LaneLine<S::W> x, y;
  unsigned fold;

  template <class Tile>
  HWY_INLINE TileLines(const PointView& p, unsigned walls, const Tile& t)
      : xi(t.load(p.xi)), eta(t.load(p.eta)), fold(walls) {
    V half = zero();
    if constexpr (S::needs_size) half = t.load(p.half);
    x = S::line(xi, half, walls & fold_left, walls & fold_right);
    y = S::line(eta, half, walls & fold_down, walls & fold_up);
  }
  HWY_INLINE bool linear_x() const { return S::linear || (fold & (fold_left | fold_right)); }
  HWY_INLINE bool linear_y() const { return S::linear || (fold & (fold_down | fold_up)); }
  // Distances of the nodes from the points, in cells.
  HWY_INLINE void arms(V* ax, V* ay) const {
    for (int a = 0; a < S::W; ++a) {
      ax[a] = set(a + S::first) - xi;
      ay[a] = set(a + S::first) - eta;
    }
  }
};

// The hats of a cell's corners (averages.hpp).
HWY_INLINE void hat_lanes(V xi, V* w) {
  w[0] = set(0.5) - xi;
  w[1] = set(0.5) + xi;
}

// sum over a line of weight times a member of the row's nodes.
template <int W>
HWY_INLINE V row_sum(const V* w, const Node* row, double Node::*member) {
  V sum = w[0] * set(row[0].*member);
  for (int a = 1; a < W; ++a) sum = hn::MulAdd(w[a], set(row[a].*member), sum);
  return sum;
}
template <int W>
HWY_INLINE V dot(const V* w, const V* v) {
  V sum = w[0] * v[0];
  for (int a = 1; a < W; ++a) sum = hn::MulAdd(w[a], v[a], sum);
  return sum;
}

// The sums over lanes of four vectors, added to memory. (Templates, so that only the branch of the lanes compiles.)
struct Four {
  V a, b, c, e;

  /// To four numbers in a row, aligned.
  HWY_INLINE void add_to(double* at) const { add(D(), at, at + 2); }
  /// To two and two.
  HWY_INLINE void add_to(double* first, double* second) const { add_halves(D(), first, second); }
  HWY_INLINE void get(double* at) const {
    for (int n = 0; n < 4; ++n) at[n] = 0;
    add(D(), at, at + 2);
  }

 private:
#if HWY_TARGET == HWY_SCALAR
  HWY_INLINE void add(D d, double* low, double* high) const { add_halves(d, low, high); }
  HWY_INLINE void add_halves(D, double* low, double* high) const {
    low[0] += hn::GetLane(a);
    low[1] += hn::GetLane(b);
    high[0] += hn::GetLane(c);
    high[1] += hn::GetLane(e);
  }
#else
  template <class Tag>
  static HWY_INLINE V pairs(Tag d, V x, V y) {
    return hn::InterleaveLower(d, x, y) + hn::InterleaveUpper(d, x, y);
  }
  template <class Tag>
  HWY_INLINE V all(Tag d) const {
    const V ab = pairs(d, a, b), ce = pairs(d, c, e);
    return hn::ConcatLowerLower(d, ce, ab) + hn::ConcatUpperUpper(d, ce, ab);
  }
  template <class Tag>
  HWY_INLINE void add(Tag d, double* low, double* high) const {
    if constexpr (n_lanes == 4) hn::Store(hn::Load(d, low) + all(d), d, low);
    else add_halves(d, low, high);
  }
  template <class Tag>
  HWY_INLINE void add_halves(Tag d, double* low, double* high) const {
    if constexpr (n_lanes == 4) {
      const hn::Half<Tag> h;
      const V sums = all(d);
      hn::StoreU(hn::LoadU(h, low) + hn::LowerHalf(h, sums), h, low);
      hn::StoreU(hn::LoadU(h, high) + hn::UpperHalf(h, sums), h, high);
    } else {
      hn::StoreU(hn::LoadU(d, low) + pairs(d, a, b), d, low);
      hn::StoreU(hn::LoadU(d, high) + pairs(d, c, e), d, high);
    }
  }
#endif
};

// Adds the sums over lanes of a[c], b[c] to two numbers of each of a stencil's nodes; at(c) is the first.
template <int N, class At>
HWY_INLINE void add_pairs(const V* a, const V* b, At&& at) {
  for (int c = 0; c + 1 < N; c += 2) Four{a[c], b[c], a[c + 1], b[c + 1]}.add_to(at(c), at(c + 1));
  if constexpr (N % 2 == 1) {
    HWY_ALIGN double last[4];
    Four{a[N - 1], b[N - 1], a[N - 1], b[N - 1]}.get(last);
    at(N - 1)[0] += last[0];
    at(N - 1)[1] += last[1];
  }
}

// F-bar of three-node shapes (averages.hpp): `a` by its weights v and the hats of a cell's corners; with `volumes` the
// weights and the cell's edges too.
HWY_INLINE void add_to_averages(const CellView& c, std::int32_t cell, bool volumes, V xi, V eta, V v, V a) {
  V hx[2], hy[2], value[4], volume[4];
  hat_lanes(xi, hx);
  hat_lanes(eta, hy);
  for (int n = 0; n < 4; ++n) {
    volume[n] = v * hx[n % 2] * hy[n / 2];
    value[n] = volume[n] * a;
  }
  CornerSums* corner = c.average.corners + cell;
  if (volumes) {
    add_pairs<4>(value, volume, [&](int n) { return &corner[n / 2 * c.nx + n % 2].value; });
    Four{hx[0] * volume[1], hx[0] * volume[3], hy[0] * volume[2], hy[0] * volume[3]}.add_to(&c.average.edges[cell].low);
  } else {
    HWY_ALIGN double sums[4];
    Four{value[0], value[1], value[2], value[3]}.get(sums);
    for (int n = 0; n < 4; ++n) corner[n / 2 * c.nx + n % 2].value += sums[n];
  }
}
// The average at the points.
HWY_INLINE V averaged(const CellView& c, std::int32_t cell, V xi, V eta) {
  V hx[2], hy[2];
  hat_lanes(xi, hx);
  hat_lanes(eta, hy);
  const double* mean = c.average.mean + cell;
  const V low = hn::MulAdd(hx[1], set(mean[1]), hx[0] * set(mean[0]));
  const V high = hn::MulAdd(hx[1], set(mean[c.nx + 1]), hx[0] * set(mean[c.nx]));
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

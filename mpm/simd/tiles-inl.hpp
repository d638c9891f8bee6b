// Lanes, and the tiles of points that fill them (lanes.hpp): loads, stores, what is live, and the cells they lie in. Included
// by the kernels' and the laws' sources inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_TILES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_TILES_INL
#undef PIVNP_MPM_TILES_INL
#else
#define PIVNP_MPM_TILES_INL
#endif

#include <hwy/cache_control.h>

#include <type_traits>

#include "mpm/state/views.hpp"
#include "mpm/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
constexpr std::size_t n_lanes = hn::MaxLanes(D());
// The lanes come in groups, each of one cell: at four points a cell more lanes than that would stay empty.
constexpr std::size_t group_lanes = 4, groups = n_lanes / group_lanes;
static_assert(n_lanes == 4 || n_lanes == 8);

HWY_INLINE V set(double v) { return hn::Set(D(), v); }
HWY_INLINE V zero() { return hn::Zero(D()); }
HWY_INLINE double sum_of(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

// One number of each group in its lanes.
HWY_INLINE V of_groups(double first, [[maybe_unused]] double second) {
  if constexpr (groups == 1) return set(first);
  else return hn::IfThenElse(hn::FirstN(D(), group_lanes), set(first), set(second));
}
// The sum over each group's lanes, in one order whatever the number of groups.
HWY_INLINE void group_sums(V v, double* out) {
  HWY_ALIGN double lane[n_lanes];
  hn::Store(v, D(), lane);
  for (std::size_t g = 0; g < groups; ++g) {
    const double* of = lane + g * group_lanes;
    out[g] = (of[0] + of[1]) + (of[2] + of[3]);
  }
}

// Of what is done with a tile: inline, or the arrays' addresses would be looked up again after every store.
#undef PIVNP_TILE
#define PIVNP_TILE HWY_ATTR __attribute__((always_inline))

// Points that lie together, one to every lane, of cells without marks.
struct FullTile {
  static constexpr bool marked = false;
  std::uint32_t first;
  HWY_INLINE V load(const double* a) const {
    if constexpr (!in_pairs) hwy::Prefetch(a + first + 96);  // (what the processor fetches by itself is soon enough for these)
    return hn::LoadU(D(), a + first);
  }
  // What the tile has loaded or stored before.
  HWY_INLINE V again(const double* a) const { return hn::LoadU(D(), a + first); }
  HWY_INLINE void store(V v, double* a) const { hn::StoreU(v, D(), a + first); }
  HWY_INLINE V live(V v) const { return v; }
  HWY_INLINE V own(V v) const { return v; }
  // Of a lane's point among its group's.
  HWY_INLINE std::uint32_t rank(std::size_t, std::size_t lane) const { return std::uint32_t(lane); }
};

// Groups whose points lie in as many places each as a group has lanes, some of which may be another cell's. The lanes that
// are left read what is there, which another thread may just be writing, and are not stored: no branch may depend on them
// (own()). They may stand where the cell has no material and its nodes any velocity: no mass of theirs makes up for what is
// not a number.
class GroupTile {
 public:
  static constexpr bool marked = true;
  /// `lanes`: those with a point, a bit each.
  HWY_INLINE GroupTile(const std::uint32_t* first, const std::uint8_t* lanes) {
    unsigned all = 0, gaps = 0;
    for (std::size_t g = 0; g < groups; ++g) {
      first_[g] = first[g];
      lanes_[g] = lanes[g];
      all |= unsigned(lanes[g]) << g * group_lanes;
      gaps |= lanes[g] & (lanes[g] + 1u);
      of_group_[g] = mask(G(), lanes[g]);
    }
    live_ = mask(D(), all);
    gaps_ = gaps != 0;
  }
  HWY_INLINE V load(const double* a) const { return loaded(D(), a); }
  HWY_INLINE V again(const double* a) const { return load(a); }
  HWY_INLINE void store(V v, double* a) const { put(D(), v, a); }
  HWY_INLINE V live(V v) const { return hn::IfThenElseZero(live_, v); }
  // Zero in lanes whose value is nobody's of the cell.
  HWY_INLINE V own(V v) const { return live(v); }
  HWY_INLINE std::uint32_t rank(std::size_t g, std::size_t lane) const {
    return std::uint32_t(hwy::PopCount(std::uint64_t(lanes_[g]) & ((1u << lane) - 1)));
  }
  // Each group's points without gaps between them.
  HWY_INLINE V packed(V v) const { return HWY_UNLIKELY(gaps_) ? without_gaps(D(), v) : v; }

 private:
  using G = std::conditional_t<groups == 2, hn::Half<D>, D>;
  template <class Tag>
  static HWY_INLINE hn::Mask<Tag> mask(Tag d, unsigned lanes) {
    const std::uint8_t bits[8] = {std::uint8_t(lanes)};
    return hn::LoadMaskBits(d, bits);
  }
  template <class Tag>
  HWY_INLINE V without_gaps(Tag d, V v) const {
    if constexpr (groups == 2) {
      const hn::Half<Tag> h;
      return hn::Combine(d, hn::Compress(hn::UpperHalf(h, v), of_group_[groups - 1]),
                         hn::Compress(hn::LowerHalf(h, v), of_group_[0]));
    } else {
      return hn::Compress(v, live_);
    }
  }
  template <class Tag>
  HWY_INLINE V loaded(Tag d, const double* a) const {
    if constexpr (!in_pairs) hwy::Prefetch(a + first_[0] + 96);
    if constexpr (groups == 1) {
      return hn::LoadU(d, a + first_[0]);
    } else {
      const hn::Half<Tag> h;
      return hn::Combine(d, hn::LoadU(h, a + first_[groups - 1]), hn::LoadU(h, a + first_[0]));
    }
  }
  template <class Tag>
  HWY_INLINE void put(Tag d, V v, double* a) const {
    if constexpr (groups == 2) {
      const hn::Half<Tag> h;
      hn::BlendedStore(hn::LowerHalf(h, v), of_group_[0], h, a + first_[0]);
      hn::BlendedStore(hn::UpperHalf(h, v), of_group_[groups - 1], h, a + first_[groups - 1]);
    } else {
      hn::BlendedStore(v, live_, d, a + first_[0]);
    }
  }

  std::uint32_t first_[groups];
  std::uint8_t lanes_[groups];
  bool gaps_;
  M live_;
  hn::Mask<G> of_group_[groups];
};

// Points anywhere. The lanes that are left repeat a point of their group's cell, and get what it gets.
struct PartTile {
  static constexpr bool marked = true;
  std::uint32_t point[n_lanes];
  std::uint8_t is_live[8] = {};  // a bit a lane

  HWY_INLINE PartTile(const std::uint32_t* order, std::size_t n) { take(0, order, n, n_lanes); }
  // Of each group `size` points from `place` of the order on.
  HWY_INLINE PartTile(const std::uint32_t* order, const std::uint32_t* place, const std::uint32_t* size) {
    for (std::size_t g = 0; g < groups; ++g) take(g * group_lanes, order + place[g] - (size[g] == 0), size[g], group_lanes);
  }
  HWY_INLINE V load(const double* a) const { return gathered(D(), a); }
  HWY_INLINE V again(const double* a) const { return load(a); }
  HWY_INLINE void store(V v, double* a) const {
    HWY_ALIGN double lane[n_lanes];
    hn::Store(v, D(), lane);
    for (std::size_t l = 0; l < n_lanes; ++l) a[point[l]] = lane[l];
  }
  HWY_INLINE V live(V v) const { return hn::IfThenElseZero(hn::LoadMaskBits(D(), is_live), v); }
  HWY_INLINE V own(V v) const { return v; }
  HWY_INLINE std::uint32_t rank(std::size_t, std::size_t lane) const { return std::uint32_t(lane); }
  HWY_INLINE V packed(V v) const { return v; }

 private:
  // `n` points to the `room` lanes from `lane` on.
  HWY_INLINE void take(std::size_t lane, const std::uint32_t* order, std::size_t n, std::size_t room) {
    std::uint32_t k = order[0];
    for (std::size_t l = 0; l < room; ++l) point[lane + l] = k = l < n ? order[l] : k;
    is_live[0] = std::uint8_t(is_live[0] | ((1u << n) - 1) << lane);
  }
  template <class Tag>
  HWY_INLINE V gathered(Tag d, const double* a) const {
    return from(d, a, 0);
  }
  template <class Tag>
  HWY_INLINE hn::Vec<Tag> from(Tag d, const double* a, std::size_t lane) const {
    if constexpr (hn::MaxLanes(Tag()) == 2) {
      return hn::OddEven(hn::Set(d, a[point[lane + 1]]), hn::Set(d, a[point[lane]]));
    } else {
      const hn::Half<Tag> h;
      return hn::Combine(d, from(h, a, lane + hn::MaxLanes(h)), from(h, a, lane));
    }
  }
};

// The cells of a tile's groups.
struct TileCells {
  Node* base[groups];           // the lower left node of the stencil
  std::size_t occupied[groups];  // place among the occupied cells
  std::uint32_t place[groups];  // of the group's first point in `order`
  unsigned marks[groups];       // CellView::marks
  double i[groups], j[groups];  // the cell's origin, in nodes, in its velocity field
  std::ptrdiff_t nx;            // nodes in a row

  HWY_INLINE unsigned any_mark() const { return marks[0] | marks[groups - 1]; }
  /// The lanes with one of these walls.
  HWY_INLINE M beside(unsigned walls) const {
    return hn::Gt(of_groups(marks[0] & walls ? 1 : 0, marks[groups - 1] & walls ? 1 : 0), zero());
  }
  /// A member of the node `n` behind `base`.
  HWY_INLINE V value(std::ptrdiff_t n, double Node::*member) const {
    return of_groups(base[0][n].*member, base[groups - 1][n].*member);
  }
};

// Of a cell's points in `order` as the next group those that lie in a row of as many places as a group has lanes, where the
// cell needs no group more for it; else false, and the next ones, `n`.
HWY_INLINE bool take_near(const std::uint32_t* order, std::uint32_t left, std::uint32_t& n, std::uint8_t& lanes) {
  constexpr std::uint32_t most = group_lanes;
  std::uint32_t near = 1;
  lanes = 1;
  for (; near < n && order[near] - order[0] < most; ++near) lanes = std::uint8_t(lanes | 1u << (order[near] - order[0]));
  if (near < n && 1 + (left - near + most - 1) / most > (left + most - 1) / most) return false;
  n = near;
  return true;
}

// Calls body(tile, cells) for the points of some range.
template <class Body>
HWY_INLINE void for_tiles(const CellView& c, Range range, Body&& body) {
  std::size_t s = range.begin;
  if (s == range.end) return;
  TileCells cells;
  cells.nx = c.nx;
  std::uint32_t q = c.begin[s];
  std::uint32_t first[groups], size[groups];  // of a group's points
  std::uint8_t lanes[groups];
  bool near = true, full = true;  // does each group lie in a row, and fill it?
  std::int32_t row = 0, row_end = 0;  // the first cell of the row, and that of the next one
  double j = 0;
  const auto take = [&](std::size_t g) PIVNP_TILE {
    const std::uint32_t left = c.begin[s + 1] - q;
    std::uint32_t n = left < group_lanes ? left : std::uint32_t(group_lanes);
    const std::int32_t cell = c.index[s];
    if (HWY_UNLIKELY(cell >= row_end)) {
      row = cell / c.nx * c.nx;
      row_end = row + c.nx;
      j = cell / c.nx % c.field_rows + c.origin;
    }
    cells.i[g] = cell - row + c.origin;
    cells.j[g] = j;
    cells.base[g] = c.node + cell;
    cells.occupied[g] = s;
    cells.place[g] = q;
    cells.marks[g] = c.marks[s];
    first[g] = c.order[q];
    if (HWY_LIKELY(c.order[q + n - 1] == first[g] + (n - 1))) lanes[g] = std::uint8_t((1u << n) - 1);
    else near = take_near(c.order + q, left, n, lanes[g]) && near;
    full = full && n == group_lanes;
    size[g] = n;
    q += n;
    s += n == left;
  };
  // Are the next points a full tile of the row, one cell's for each group? As nearly all: with few operations.
  const auto take_full = [&]() PIVNP_TILE {
    if (q != c.begin[s] || s + groups > range.end) return false;
    const std::uint32_t* of = c.order + q;
    const std::int32_t* cell = c.index + s;
    const std::uint32_t point = of[0];
    bool is = cell[groups - 1] < row_end;
    for (std::size_t g = 0; g < groups; ++g)
      is = is && c.marks[s + g] == 0 && c.begin[s + g + 1] == q + (g + 1) * group_lanes;
    is = is && of[group_lanes - 1] == point + (group_lanes - 1);  // (after it is known that there are as many)
    if constexpr (groups == 2)
      is = is && of[group_lanes] == point + group_lanes && of[n_lanes - 1] == point + (n_lanes - 1);
    if (!is) return false;
    first[0] = point;
    for (std::size_t g = 0; g < groups; ++g) {
      cells.i[g] = cell[g] - row + c.origin;
      cells.j[g] = j;
      cells.base[g] = c.node + cell[g];
      cells.occupied[g] = s + g;
      cells.place[g] = q + std::uint32_t(g * group_lanes);
      cells.marks[g] = 0;
    }
    q += n_lanes;
    s += groups;
    return true;
  };
  while (s < range.end) {
    if (HWY_UNLIKELY(!take_full())) {
      near = full = true;
      take(0);
      if constexpr (groups == 2) {
        if (HWY_LIKELY(s < range.end)) {
          take(1);
          full = full && first[1] == first[0] + group_lanes;
        } else {  // the first cell once more, with no points
          cells.base[1] = cells.base[0];
          cells.i[1] = cells.i[0];
          cells.j[1] = cells.j[0];
          cells.occupied[1] = cells.occupied[0];
          cells.place[1] = cells.place[0] + size[0];
          cells.marks[1] = cells.marks[0];
          first[1] = first[0];
          lanes[1] = 0;
          size[1] = 0;
          full = false;
        }
      }
      if (!(near && full && cells.any_mark() == 0)) {
        if (near && first[0] + group_lanes <= c.points && first[groups - 1] + group_lanes <= c.points)
          body(GroupTile(first, lanes), cells);
        else
          body(PartTile(c.order, cells.place, size), cells);
        continue;
      }
    }
    body(FullTile{first[0]}, cells);
  }
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

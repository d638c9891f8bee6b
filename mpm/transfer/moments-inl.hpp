// What a tile's points give to the nodes of their cells, from sums of powers of their places: away from walls, with eight lanes
// and B-splines. Included by the kernels' sources inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_MOMENTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_MOMENTS_INL
#undef PIVNP_MPM_MOMENTS_INL
#else
#define PIVNP_MPM_MOMENTS_INL
#endif

#include <type_traits>

#include "mpm/transfer/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Two numbers of a point, such as the components of a vector.
struct Both {
  V x, y;
};

// Along an axis the weights of a cell's three nodes are (e - o)/2, z, (e + o)/2 with z = 3/4 - s^2, o = s, e = 1 - z. So the
// nodes' sums follow from those of 1, s and z (total, odd, middle) once the lanes are added up; with the affine field
// v + c (s_i - s) these are v, v s + c/4 and (v - c s) z, and of the slopes 0, 1 and -2 s. Two numbers go together through
// the lanes (InPairs).
class CellMoments {
 public:
  template <class Shape>
  static constexpr bool serve = std::is_same_v<Shape, BSplineShape> && n_lanes == 8;
  static HWY_INLINE bool hold(const TileCells& cells) {
    return !(cells.any_mark() & (wall_left | wall_right | wall_down | wall_up | wall_moved));
  }

  HWY_INLINE CellMoments(V xi, V eta) : own_(xi, eta), other_(swapped(xi), swapped(eta)) {}

  HWY_INLINE void take_mass(V m) {
    const V low = set(0.5) - own_.xi, high = set(0.5) + own_.xi;
    const Pair edge({m * (low * low), m * (high * high)});
    const V inner = m * own_.z, inner_other = swapped(inner);
    const V edges[] = {edge.own + edge.other, hn::MulAdd(edge.own, own_.eta, edge.other * other_.eta),
                       hn::MulAdd(edge.own, own_.zeta, edge.other * other_.zeta)};
    const V middles[] = {inner + inner_other, hn::MulAdd(inner, own_.eta, inner_other * other_.eta),
                         hn::MulAdd(inner, own_.zeta, inner_other * other_.zeta)};
    for (int k = 0; k < 3; ++k) mass_[k] = of_groups_of(edges[k], middles[k]);
    spread(mass_[0], mass_[1], mass_[2]);
  }
  /// Momentum v, and what it grows by from cell to cell along x and y.
  HWY_INLINE void take_momentum(const Both& v, const Both& along_x, const Both& along_y) {
    const Pair p(v), cx(along_x), cy(along_y);
    const V quarter = set(0.25), cx_own = quarter * cx.own, cx_other = quarter * cx.other, cy_own = quarter * cy.own,
            cy_other = quarter * cy.other;
    // (As without affine field at xi = 0, at eta = 0.)
    const V x_own = hn::NegMulAdd(cx.own, own_.xi, p.own), x_other = hn::NegMulAdd(cx.other, other_.xi, p.other);
    const V y_own = hn::NegMulAdd(cy.own, own_.eta, p.own), y_other = hn::NegMulAdd(cy.other, other_.eta, p.other);
    const V odd_own = hn::MulAdd(p.own, own_.xi, cx_own), odd_other = hn::MulAdd(p.other, other_.xi, cx_other);
    momentum_[total][total] = p.own + p.other;
    momentum_[total][odd] = odd_own + odd_other;
    momentum_[total][middle] = both(own_.z, x_own, other_.z, x_other);
    momentum_[odd][total] = hn::MulAdd(p.own, own_.eta, hn::MulAdd(p.other, other_.eta, cy_own + cy_other));
    momentum_[odd][odd] = hn::MulAdd(odd_own, own_.eta, own_.xi * cy_own) + hn::MulAdd(odd_other, other_.eta, other_.xi * cy_other);
    momentum_[odd][middle] =
        both(own_.z, hn::MulAdd(x_own, own_.eta, cy_own), other_.z, hn::MulAdd(x_other, other_.eta, cy_other));
    momentum_[middle][total] = both(own_.zeta, y_own, other_.zeta, y_other);
    momentum_[middle][odd] =
        both(own_.zeta, hn::MulAdd(y_own, own_.xi, cx_own), other_.zeta, hn::MulAdd(y_other, other_.xi, cx_other));
    momentum_[middle][middle] = both(own_.z * own_.zeta, hn::NegMulAdd(cy.own, own_.eta, x_own), other_.z * other_.zeta,
                                     hn::NegMulAdd(cy.other, other_.eta, x_other));
  }
  /// Forces by the slopes along x, and by those along y.
  HWY_INLINE void take_force(const Both& by_x, const Both& by_y) {
    const Pair a(by_x), b(by_y);
    const V a_own = a.own * (own_.xi + own_.xi), a_other = a.other * (other_.xi + other_.xi);
    const V b_own = b.own * (own_.eta + own_.eta), b_other = b.other * (other_.eta + other_.eta);
    force_[total][total] = zero();
    force_[total][odd] = a.own + a.other;
    force_[total][middle] = hn::Neg(a_own + a_other);
    force_[odd][total] = b.own + b.other;
    force_[odd][odd] = both(a.own, own_.eta, a.other, other_.eta) + both(b.own, own_.xi, b.other, other_.xi);
    force_[odd][middle] = both(b.own, own_.z, b.other, other_.z) - both(a_own, own_.eta, a_other, other_.eta);
    force_[middle][total] = hn::Neg(b_own + b_other);
    force_[middle][odd] = both(a.own, own_.zeta, a.other, other_.zeta) - both(b_own, own_.xi, b_other, other_.xi);
    force_[middle][middle] = hn::Neg(both(a_own, own_.zeta, a_other, other_.zeta) + both(b_own, own_.z, b_other, other_.z));
  }

  /// To five numbers in a row, momentum, force and mass, at at(group, i, j) of the node i, j of the cell: the first of a
  /// cache line, whose last three stay.
  template <class At>
  HWY_INLINE void add(At&& at) const {
    V sums[3][3];
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) sums[j][i] = of_groups_of(momentum_[j][i], force_[j][i]);
    for (int j = 0; j < 3; ++j) spread(sums[j][0], sums[j][1], sums[j][2]);
    for (int i = 0; i < 3; ++i) spread(sums[0][i], sums[1][i], sums[2][i]);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const double scale = (i == 1 ? 1 : 0.5) * (j == 1 ? 1 : 0.5);
        add_line(D(), sums[j][i], mass_of_node(i, j), scale, at(0, i, j), at(1, i, j));
      }
  }

 private:
  enum { total, odd, middle };
  struct Place {
    V xi, eta, z, zeta;
    HWY_INLINE Place(V x, V y) : xi(x), eta(y), z(hn::NegMulAdd(x, x, set(0.75))), zeta(hn::NegMulAdd(y, y, set(0.75))) {}
  };
  struct Pair : InPairs {
    explicit HWY_INLINE Pair(const Both& v) : InPairs(v.x, v.y) {}
  };
  static HWY_INLINE V swapped(V v) { return InPairs::swapped(v); }
  static HWY_INLINE V both(V a, V x, V b, V y) { return hn::MulAdd(a, x, b * y); }

  HWY_INLINE V mass_of_node(int i, int j) const {
    if constexpr (n_lanes == 8) return first_of(mass_[j], i);
    else return mass_[j];
  }
  template <class T>
  static HWY_INLINE T first_of(T v, int i) {
    return i == 0 ? v : i == 1 ? hn::SwapAdjacentBlocks(v) : swapped(v);
  }

  static HWY_INLINE V of_groups_of(V a, V b) { return sums_of_pairs(D(), a, b); }
  // Of total, odd and middle: twice the low node's, the middle one's, twice the high one's.
  static HWY_INLINE void spread(V& first, V& second, V& third) {
    const V even = first - third, o = second;
    first = even - o;
    second = third;
    third = even + o;
  }
  // `mass` begins each group's lanes.
  template <class Tag>
  static HWY_INLINE void add_line(Tag d, V sums, V mass, double scale, double* first, double* second) {
    if constexpr (n_lanes == 8) {
      HWY_ALIGN const double by[8] = {scale, scale, scale, scale, scale, 0, 0, 0};
      const V of = hn::Load(d, by);
      hn::Store(hn::MulAdd(of, hn::ConcatLowerLower(d, mass, sums), hn::Load(d, first)), d, first);
      hn::Store(hn::MulAdd(of, hn::ConcatUpperUpper(d, mass, sums), hn::Load(d, second)), d, second);
    }
  }

  Place own_, other_;
  V mass_[3];  // of the rows: twice the low node's, twice the high one's, the middle one's
  V momentum_[3][3], force_[3][3];
};

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// What is done at the corners and cells, as many at a time as lie together in a row and the processor has lanes.
#include "mpm/grid/averages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/grid/averages_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include <hwy/cache_control.h>

#include "mpm/simd/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

template <class Tag>
struct Cells {
  using V = hn::Vec<Tag>;
  const Tag d;
  const AverageArrays& a;
  const std::ptrdiff_t n;

  // What is wanted of the nodes that come in a while: the arrays are too many for the processor to follow them by
  // itself.
  template <class T>
  HWY_INLINE void ahead(const T* at) const {
    const auto* from = reinterpret_cast<const char*>(at + n + 24);
    for (std::size_t line = 0; line < hn::MaxLanes(d) * sizeof(T); line += 64) hwy::Prefetch(from + line);
  }

  // Numbers that lie side by side, four or two a node.
  struct Four {
    V low, high, left, right;
  };
  struct Two {
    V x, y;
  };
  HWY_INLINE Four edges(std::ptrdiff_t from = 0) const {
    Four s;
    hn::LoadInterleaved4(d, &a.edges[n + from].low, s.low, s.high, s.left, s.right);
    return s;
  }
  HWY_INLINE Two axes(const AlongAxes* field, std::ptrdiff_t from = 0) const {
    Two t;
    hn::LoadInterleaved2(d, &field[n + from].x, t.x, t.y);
    return t;
  }
  HWY_INLINE void put(V x, V y, AlongAxes* field) const { hn::StoreInterleaved2(x, y, d, &field[n].x); }

  HWY_INLINE void take_edges() const {
    ahead(a.edges);
    ahead(a.corners);
    ahead(a.fluxes);
    ahead(a.shift);
    const Four here = edges(), below = edges(-a.row), before = edges(-1), diagonal = edges(-a.row - 1);
    const V edge_x = here.low + below.high, edge_y = here.left + before.right;
    V value, volume;
    hn::LoadInterleaved2(d, &a.corners[n].value, value, volume);
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const V per = hn::IfThenElseZero(hn::Gt(volume, zero), one / hn::IfThenElse(hn::Gt(volume, zero), volume, one));
    hn::StoreInterleaved2(value, per, d, &a.corners[n].value);
    put(edge_x, edge_y, a.fluxes);
    put(per * ((before.low + diagonal.high) - edge_x), per * ((below.left + diagonal.right) - edge_y), a.shift);
  }

  HWY_INLINE V share(V edge, V across, V other) const {
    const V both = across + other;
    return edge * (across / hn::IfThenElse(hn::Gt(both, hn::Zero(d)), both, hn::Set(d, 1.0)));
  }
  HWY_INLINE void take_shares() const {
    ahead(a.edges);
    ahead(a.fluxes + 2 * a.row);
    const Two edge = axes(a.fluxes);
    const V above = axes(a.fluxes, a.row).x, beside = axes(a.fluxes, 1).y;
    const V low = share(edge.x, above, axes(a.fluxes, -a.row).x), high = share(above, edge.x, axes(a.fluxes, 2 * a.row).x);
    const V left = share(edge.y, beside, axes(a.fluxes, -1).y), right = share(beside, edge.y, axes(a.fluxes, 2).y);
    hn::StoreInterleaved4(low, high, left, right, d, &a.edges[n].low);
  }

  struct Inverse {
    V xx, xy, yx, yy;
  };
  // S^-1.
  HWY_INLINE Inverse inverse(const Four& share) const {
    // Where points are too few or too close for a gradient: the least eigenvalue of S, in units of what it is far from
    // surfaces (1), is raised to this.
    const V least_spread = hn::Set(d, 0.05), zero = hn::Zero(d), one = hn::Set(d, 1.0), half_of = hn::Set(d, 0.5);
    const Two c0 = axes(a.shift), c1 = axes(a.shift, 1), c2 = axes(a.shift, a.row), c3 = axes(a.shift, a.row + 1);
    V along_x = share.low + share.high, along_y = share.left + share.right;
    const auto no_x = hn::Le(along_x, zero), no_y = hn::Le(along_y, zero);
    V xx = along_x - share.low * (c1.x - c0.x) - share.high * (c3.x - c2.x);
    V yy = along_y - share.left * (c2.y - c0.y) - share.right * (c3.y - c1.y);
    const V xy = hn::IfThenZeroElse(no_y, share.low * (c0.y - c1.y) + share.high * (c2.y - c3.y));
    const V yx = hn::IfThenZeroElse(no_x, share.left * (c0.x - c2.x) + share.right * (c1.x - c3.x));
    along_x = hn::IfThenElse(no_x, one, along_x);
    along_y = hn::IfThenElse(no_y, one, along_y);
    xx = hn::IfThenElse(no_x, one, xx);
    yy = hn::IfThenElse(no_y, one, yy);
    const V size = along_x * along_y, by_x = xx * along_y, by_y = yy * along_x;
    const V half = half_of * (by_x - by_y), mean = half_of * (by_x + by_y), off = half_of * (xy + yx);
    const V apart2 = half * half + off * off * size, above = mean - least_spread * size;
    // Mostly not: no root, no quotient.
    if (HWY_UNLIKELY(!hn::AllTrue(d, hn::And(hn::Ge(above, zero), hn::Ge(above * above, apart2))))) {
      const V lack = hn::Max(zero, hn::Sqrt(apart2) - above) / size;
      xx = xx + lack * along_x;
      yy = yy + lack * along_y;
    }
    const V per = one / (xx * yy - xy * yx);
    return {per * yy, hn::Neg(per * xy), hn::Neg(per * yx), per * xx};
  }

  HWY_INLINE V corner(std::ptrdiff_t from) const {
    V value, per_volume;
    hn::LoadInterleaved2(d, &a.corners[n + from].value, value, per_volume);
    return value * per_volume;
  }
  HWY_INLINE void take_fluxes(bool adjoint) const {
    ahead(a.edges);
    ahead(a.shift + a.row);
    ahead(a.corners + a.row);
    ahead(a.fluxes);
    const Four share = edges();
    const Inverse by = inverse(share);
    const V b0 = corner(0), b1 = corner(1), b2 = corner(a.row), b3 = corner(a.row + 1);
    const V ux = share.low * (b1 - b0) + share.high * (b3 - b2), uy = share.left * (b2 - b0) + share.right * (b3 - b1);
    put(by.xx * ux + (adjoint ? by.yx : by.xy) * uy, (adjoint ? by.xy : by.yx) * ux + by.yy * uy, a.fluxes);
  }

  HWY_INLINE void take_means() const {
    const std::ptrdiff_t up = -a.row;
    const Two here = axes(a.fluxes), left = axes(a.fluxes, -1), low = axes(a.fluxes, up), both = axes(a.fluxes, up - 1);
    const Four share = edges(), of_left = edges(-1), of_low = edges(up), of_both = edges(up - 1);
    const V x_above = of_left.low * left.x - share.low * here.x, x_below = of_both.high * both.x - of_low.high * low.x;
    const V y_after = of_low.left * low.y - share.left * here.y, y_before = of_both.right * both.y - of_left.right * left.y;
    const V x = x_above + x_below, y = y_after + y_before;
    V value, per_volume;
    hn::LoadInterleaved2(d, &a.corners[n].value, value, per_volume);
    hn::StoreInterleaved2(per_volume * (value + (x + y)), per_volume, d, &a.corners[n].value);
  }
};

void edges_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_edges(); });
}
void shares_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_shares(); });
}
void fluxes_of(const AverageArrays& a, bool adjoint, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR {
    Cells<decltype(d)>{d, a, n}.take_fluxes(adjoint);
  });
}
void means_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_means(); });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(edges_of);
HWY_EXPORT(shares_of);
HWY_EXPORT(fluxes_of);
HWY_EXPORT(means_of);

void take_edges(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(edges_of)(a, nodes, size);
}
void take_shares(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(shares_of)(a, nodes, size);
}
void take_fluxes(const AverageArrays& a, Averaging which, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(fluxes_of)(a, which == Averaging::of_strain, nodes, size);
}
void take_means(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(means_of)(a, nodes, size);
}

}  // namespace pivnp::mpm
#endif

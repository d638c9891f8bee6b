// What is done at the corners and cells, as many at a time as lie together in a row and the processor has lanes.
#include "mpm/averages.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/averages_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Calls body(tag, n) for the nodes of a list, n the first of as many as the tag has lanes.
template <class Body>
HWY_INLINE void for_runs(const std::uint32_t* nodes, std::size_t size, Body&& body) {
  const hn::CappedTag<double, 4> all;
  const hn::CappedTag<double, 1> one;
  const std::size_t lanes = hn::Lanes(all);
  for (std::size_t k = 0; k < size;) {
    if (k + lanes <= size && nodes[k + lanes - 1] == nodes[k] + (lanes - 1)) {
      body(all, std::ptrdiff_t(nodes[k]));
      k += lanes;
    } else {
      body(one, std::ptrdiff_t(nodes[k++]));
    }
  }
}

template <class Tag>
struct Cells {
  using V = hn::Vec<Tag>;
  const Tag d;
  const AverageArrays& a;
  const std::ptrdiff_t n;

  HWY_INLINE V at(const double* field, std::ptrdiff_t from = 0) const { return hn::LoadU(d, field + n + from); }
  HWY_INLINE void put(V v, double* field) const { hn::StoreU(v, d, field + n); }

  struct Sums {
    V low, high, left, right;
  };
  HWY_INLINE Sums sums(std::ptrdiff_t from) const {
    Sums s;
    hn::LoadInterleaved4(d, &a.edges[n + from].low, s.low, s.high, s.left, s.right);
    return s;
  }

  HWY_INLINE void take_edges() const {
    const Sums here = sums(0), below = sums(-a.row), before = sums(-1), diagonal = sums(-a.row - 1);
    const V edge_x = here.low + below.high, edge_y = here.left + before.right;
    V value, volume;
    hn::LoadInterleaved2(d, &a.corners[n].value, value, volume);
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const V per = hn::IfThenElseZero(hn::Gt(volume, zero), one / hn::IfThenElse(hn::Gt(volume, zero), volume, one));
    hn::StoreInterleaved2(value, per, d, &a.corners[n].value);
    put(edge_x, a.edge_x);
    put(edge_y, a.edge_y);
    put(per * ((before.low + diagonal.high) - edge_x), a.shift_x);
    put(per * ((below.left + diagonal.right) - edge_y), a.shift_y);
  }

  HWY_INLINE V share(V edge, V across, V other) const {
    const V both = across + other;
    return edge * (across / hn::IfThenElse(hn::Gt(both, hn::Zero(d)), both, hn::Set(d, 1.0)));
  }

  HWY_INLINE void take_cells() const {
    // Where points are too few or too close for a gradient: the least eigenvalue of S, in units of what it is far from
    // surfaces (1), is raised to this.
    const V least_spread = hn::Set(d, 0.05), zero = hn::Zero(d), one = hn::Set(d, 1.0), half_of = hn::Set(d, 0.5);
    const V edge_x = at(a.edge_x), edge_y = at(a.edge_y), above = at(a.edge_x, a.row), beside = at(a.edge_y, 1);
    const V low = share(edge_x, above, at(a.edge_x, -a.row)), high = share(above, edge_x, at(a.edge_x, 2 * a.row));
    const V left = share(edge_y, beside, at(a.edge_y, -1)), right = share(beside, edge_y, at(a.edge_y, 2));
    put(low, a.low);
    put(high, a.high);
    put(left, a.left);
    put(right, a.right);
    const V x0 = at(a.shift_x), x1 = at(a.shift_x, 1), x2 = at(a.shift_x, a.row), x3 = at(a.shift_x, a.row + 1);
    const V y0 = at(a.shift_y), y1 = at(a.shift_y, 1), y2 = at(a.shift_y, a.row), y3 = at(a.shift_y, a.row + 1);
    V along_x = low + high, along_y = left + right;
    const auto no_x = hn::Le(along_x, zero), no_y = hn::Le(along_y, zero);
    V xx = along_x - low * (x1 - x0) - high * (x3 - x2), yy = along_y - left * (y2 - y0) - right * (y3 - y1);
    const V xy = hn::IfThenZeroElse(no_y, low * (y0 - y1) + high * (y2 - y3));
    const V yx = hn::IfThenZeroElse(no_x, left * (x0 - x2) + right * (x1 - x3));
    along_x = hn::IfThenElse(no_x, one, along_x);
    along_y = hn::IfThenElse(no_y, one, along_y);
    xx = hn::IfThenElse(no_x, one, xx);
    yy = hn::IfThenElse(no_y, one, yy);
    const V size = along_x * along_y, by_x = xx * along_y, by_y = yy * along_x;
    const V half = half_of * (by_x - by_y), mean = half_of * (by_x + by_y), off = half_of * (xy + yx);
    const V least = mean - hn::Sqrt(half * half + off * off * size);
    const V lack = hn::Max(zero, least_spread * size - least) / size;
    xx = xx + lack * along_x;
    yy = yy + lack * along_y;
    const V per = one / (xx * yy - xy * yx);
    put(per * yy, a.xx);
    put(hn::Neg(per * xy), a.xy);
    put(hn::Neg(per * yx), a.yx);
    put(per * xx, a.yy);
  }

  HWY_INLINE V corner(std::ptrdiff_t from) const {
    V value, per_volume;
    hn::LoadInterleaved2(d, &a.corners[n + from].value, value, per_volume);
    return value * per_volume;
  }

  HWY_INLINE void take_fluxes(bool adjoint) const {
    const V b0 = corner(0), b1 = corner(1), b2 = corner(a.row), b3 = corner(a.row + 1);
    const V ux = at(a.low) * (b1 - b0) + at(a.high) * (b3 - b2), uy = at(a.left) * (b2 - b0) + at(a.right) * (b3 - b1);
    put(at(a.xx) * ux + at(adjoint ? a.yx : a.xy) * uy, a.flux_x);
    put(at(adjoint ? a.xy : a.yx) * ux + at(a.yy) * uy, a.flux_y);
  }

  HWY_INLINE void take_means() const {
    const std::ptrdiff_t up = -a.row;
    const V here_x = at(a.flux_x), here_y = at(a.flux_y), left_x = at(a.flux_x, -1), left_y = at(a.flux_y, -1);
    const V low_x = at(a.flux_x, up), low_y = at(a.flux_y, up), both_x = at(a.flux_x, up - 1),
            both_y = at(a.flux_y, up - 1);
    const V x_above = at(a.low, -1) * left_x - at(a.low) * here_x,
            x_below = at(a.high, up - 1) * both_x - at(a.high, up) * low_x;
    const V y_after = at(a.left, up) * low_y - at(a.left) * here_y,
            y_before = at(a.right, up - 1) * both_y - at(a.right, -1) * left_y;
    const V x = x_above + x_below, y = y_after + y_before;
    V value, per_volume;
    hn::LoadInterleaved2(d, &a.corners[n].value, value, per_volume);
    put(per_volume * (value + (x + y)), a.mean);
  }
};

void edges_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_edges(); });
}
void cells_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_cells(); });
}
void fluxes_of(const AverageArrays& a, bool adjoint, const std::uint32_t* nodes, std::size_t size) {
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_fluxes(adjoint); });
}
void means_of(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { Cells<decltype(d)>{d, a, n}.take_means(); });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(edges_of);
HWY_EXPORT(cells_of);
HWY_EXPORT(fluxes_of);
HWY_EXPORT(means_of);

void take_edges(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(edges_of)(a, nodes, size);
}
void take_cells(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(cells_of)(a, nodes, size);
}
void take_fluxes(const AverageArrays& a, Averaging which, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(fluxes_of)(a, which == Averaging::of_strain, nodes, size);
}
void take_means(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(means_of)(a, nodes, size);
}

}  // namespace pivnp::mpm
#endif

// The projected flow: conjugate gradients on the nodes, and what the points get of it.
#include "mpm/water/pore_projection_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/water/pore_projection_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/simd/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// A sum over the nodes of a list, in lanes and then over them, whatever the runs: four sums, one a place in the list modulo four.
struct ListSum {
  double of[4] = {};
  std::size_t next = 0;
  template <class Tag, class Vector>
  HWY_INLINE void add(Tag d, Vector v) {
    HWY_ALIGN double lane[4];
    hn::StoreU(v, d, lane);
    for (std::size_t l = 0; l < hn::Lanes(d); ++l) of[next++ % 4] += lane[l];
  }
  HWY_INLINE double all() const { return (of[0] + of[1]) + (of[2] + of[3]); }
};

template <class Tag>
struct AtNodes {
  using V = hn::Vec<Tag>;
  const Tag d;
  const PoreSystem& s;
  const std::ptrdiff_t n;

  HWY_INLINE V at(const double* values, std::ptrdiff_t from = 0) const { return hn::LoadU(d, values + n + from); }
  HWY_INLINE void put(V v, double* to) const { hn::StoreU(v, d, to + n); }

  // The direction by the matrix.
  HWY_INLINE V product() const {
    const V own = at(s.direction);
    const V along_x = at(s.along_x) * at(s.direction, 1) + at(s.along_x, -1) * at(s.direction, -1);
    const V along_y = at(s.along_y) * at(s.direction, s.row) + at(s.along_y, -s.row) * at(s.direction, -s.row);
    const V result = at(s.diagonal) * own - (along_x + along_y);
    put(result, s.product);
    return own * result;
  }
  HWY_INLINE V advance(double step) const {
    const V by = hn::Set(d, step);
    put(hn::MulAdd(by, at(s.direction), at(s.solution)), s.solution);
    const V left = hn::NegMulAdd(by, at(s.product), at(s.residual));
    put(left, s.residual);
    return left * left * at(s.inverse);
  }
  HWY_INLINE void turn(double share) const {
    put(hn::MulAdd(hn::Set(d, share), at(s.direction), at(s.residual) * at(s.inverse)), s.direction);
  }
};

double product_range(const PoreSystem& s, const std::uint32_t* nodes, std::size_t size) {
  ListSum sum;
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { sum.add(d, AtNodes<decltype(d)>{d, s, n}.product()); });
  return sum.all();
}
double advance_range(const PoreSystem& s, double step, const std::uint32_t* nodes, std::size_t size) {
  ListSum sum;
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { sum.add(d, AtNodes<decltype(d)>{d, s, n}.advance(step)); });
  return sum.all();
}
void turn_range(const PoreSystem& s, double share, const std::uint32_t* nodes, std::size_t size) {
  for_runs(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { AtNodes<decltype(d)>{d, s, n}.turn(share); });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(product_range);
HWY_EXPORT(advance_range);
HWY_EXPORT(turn_range);

double product_lanes(const PoreSystem& s, const std::uint32_t* nodes, std::size_t size) {
  return HWY_DYNAMIC_DISPATCH(product_range)(s, nodes, size);
}
double advance_lanes(const PoreSystem& s, double step, const std::uint32_t* nodes, std::size_t size) {
  return HWY_DYNAMIC_DISPATCH(advance_range)(s, step, nodes, size);
}
void turn_lanes(const PoreSystem& s, double share, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(turn_range)(s, share, nodes, size);
}

}  // namespace pivnp::mpm
#endif

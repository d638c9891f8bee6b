// What nodes exchange with their neighbours, as many at a time as lie together in a row and the processor has lanes.
#include "mpm/water/pore_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mpm/water/pore_node_lanes.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for every instruction set
#include <hwy/highway.h>

#include "mpm/simd/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Four numbers in a row of each lane's node.
template <class Tag, class V = hn::Vec<Tag>>
HWY_INLINE void load_fours(Tag d, const double* first, V& a, V& b, V& c, V& e) {
#if HWY_MAX_BYTES == 64
  if constexpr (hn::MaxLanes(Tag()) == 8) {  // two lookups a number, where Highway takes five
    const V at[] = {hn::LoadU(d, first), hn::LoadU(d, first + 8), hn::LoadU(d, first + 16), hn::LoadU(d, first + 24)};
    const V even[] = {hn::ConcatEven(d, at[1], at[0]), hn::ConcatEven(d, at[3], at[2])};
    const V odd[] = {hn::ConcatOdd(d, at[1], at[0]), hn::ConcatOdd(d, at[3], at[2])};
    a = hn::ConcatEven(d, even[1], even[0]);
    c = hn::ConcatOdd(d, even[1], even[0]);
    b = hn::ConcatEven(d, odd[1], odd[0]);
    e = hn::ConcatOdd(d, odd[1], odd[0]);
    return;
  }
#endif
  hn::LoadInterleaved4(d, first, a, b, c, e);
}

// From the sums of as many nodes as the tag has lanes.
template <class Tag>
struct FromSums {
  using V = hn::Vec<Tag>;
  const Tag d;
  const PoreSumsView& sums;
  const PoreFields& f;
  const PoreEdges& edges;
  const std::ptrdiff_t n;

  struct Four {
    V a, b, c, e;
  };
  HWY_INLINE Four four(const double* first) const {
    Four s;
    load_fours(d, first, s.a, s.b, s.c, s.e);
    return s;
  }
  HWY_INLINE Four node(std::ptrdiff_t from = 0) const { return four(&sums.node[n + from].volume); }
  HWY_INLINE Four element(std::ptrdiff_t from) const { return four(&sums.element[n + from].inside); }
  HWY_INLINE V number(double value) const { return hn::Set(d, value); }
  HWY_INLINE V quotient(V a, V b) const {
    const V none = hn::Zero(d);
    return hn::IfThenElseZero(hn::Gt(b, none), a / hn::IfThenElse(hn::Gt(b, none), b, number(1)));
  }
  HWY_INLINE void put(V v, double* to) const { hn::StoreU(v, d, to + n); }
  HWY_INLINE void put(V v, float* to) const { store_single(v, d, to + n); }
  HWY_INLINE V at(const double* values) const { return hn::LoadU(d, values + n); }
  HWY_INLINE V mobility(const Four& e) const { return f.rate ? quotient(e.e, e.a) : number(edges.mobility_all); }
  // What two elements let through along the edge between them, less what their points pass on at the rate of a cell; and half of what these do.
  template <class Half>
  HWY_INLINE void edge(const Four& one, V across_one, const Four& other, V across_other, V end, V volume, double through, float* flow,
                       float* strain, Half&& half) const {
    const V none = hn::Zero(d);
    const auto of = [&](const Four& e, V across) HWY_ATTR { return mobility(e) * (number(through) * e.a - number(edges.rate) * across); };
    const auto there = hn::And(hn::Gt(volume, none), hn::Gt(end, none));
    const bool of_means = f.rate && f.inert_x;  // there strain is not smoothed, and means are weighted
    const auto passes = [&](const Four& e, V across) HWY_ATTR { return of_means ? mobility(e) * across : across; };
    put(hn::IfThenElseZero(there, half(of(one, across_one), of(other, across_other))), flow);
    put(hn::IfThenElseZero(there, half(passes(one, across_one), passes(other, across_other))), strain);
  }

  // The same for pressures: what flows, and what the skeleton yields.
  template <class Half>
  HWY_INLINE void inert(const Four& one, const Four& other, V end, V volume, double through, double yields, double* to, Half&& half) const {
    const V none = hn::Zero(d);
    const auto of = [&](const Four& e) HWY_ATTR { return (mobility(e) * number(through) + number(yields)) * e.a; };
    put(hn::IfThenElseZero(hn::And(hn::Gt(volume, none), hn::Gt(end, none)), half(of(one), of(other))), to);
  }

  // Those that have no empty element beside them, nor little around them.
  HWY_INLINE hn::Mask<Tag> take() const {
    const Four here = node(), e = element(0), left = element(-1), below = element(-f.row), across = element(-f.row - 1);
    const V v = here.a, none = hn::Zero(d);
    const V per_volume = quotient(number(1), v);
    put(v, f.volume);
    put(e.a, f.weight);
    put(here.b * (f.rate ? quotient(number(1), here.e) : per_volume), f.potential);
    put(here.c * per_volume, f.mean);
    if (f.rate) put(here.e * per_volume, f.rate);
    put(hn::Min(number(1), quotient(number(4) * v, (e.a + left.a) + (below.a + across.a))), f.even);
    const auto half = [&](V a, V b) HWY_ATTR { return number(0.5) * (a + b); };
    const auto along_y = [&](auto&& share) HWY_ATTR {
      edge(e, e.c, left, left.c, node(f.row).a, v, edges.through_y, f.flow_y, f.strain_y, share);
      if (f.inert_x) inert(e, left, node(f.row).a, v, edges.through_y, edges.inert_y, f.inert_y, share);
    };
    edge(e, e.b, below, below.b, node(1).a, v, edges.through_x, f.flow_x, f.strain_x, half);
    if (f.inert_x) inert(e, below, node(1).a, v, edges.through_x, edges.inert_x, f.inert_x, half);
    if (f.radius) along_y([&](V a, V b) HWY_ATTR { return at(f.of_right) * a + at(f.of_left) * b; });
    else along_y(half);
    const auto full = hn::And(hn::And(hn::Gt(e.a, none), hn::Gt(left.a, none)), hn::And(hn::Gt(below.a, none), hn::Gt(across.a, none)));
    const V least = f.radius ? number(edges.least_volume) * at(f.radius) : number(edges.least_volume);
    return hn::And(full, hn::Ge(v, least));
  }
};

template <class Tag>
struct AtNodes {
  using V = hn::Vec<Tag>;
  const Tag d;
  const PoreFields& f;
  const std::ptrdiff_t n;

  HWY_INLINE V at(const double* values, std::ptrdiff_t from = 0) const { return hn::LoadU(d, values + n + from); }
  HWY_INLINE V per_volume(V sum, V volume) const {
    const V zero = hn::Zero(d);
    return hn::IfThenElseZero(hn::Gt(volume, zero), sum / hn::IfThenElse(hn::Gt(volume, zero), volume, hn::Set(d, 1.0)));
  }

  HWY_INLINE V at(const float* values, std::ptrdiff_t from = 0) const { return load_single(d, values + n + from); }

  HWY_INLINE void weigh() const {
    const V least = hn::Min(hn::Min(at(f.even), at(f.even, 1)), hn::Min(at(f.even, f.row), at(f.even, f.row + 1)));
    store_single(at(f.weight) * least, d, f.weight + n);
  }
  // What the element that goes by the node `from` further on passes to this node, which is one of its four.
  HWY_INLINE V of_element(const double* of, V own, std::ptrdiff_t from) const {
    const V sum = (at(of, from) + at(of, from + 1)) + (at(of, from + f.row) + at(of, from + f.row + 1));
    return at(f.weight, from) * (sum - hn::Set(d, 4.0) * own);
  }
  HWY_INLINE void smooth(const double* from, double* to) const {
    const V own = at(from);
    const V gain = (of_element(from, own, 0) + of_element(from, own, -1)) +
                   (of_element(from, own, -f.row) + of_element(from, own, -f.row - 1));
    hn::StoreU(hn::MulAdd(hn::Set(d, 1.0 / 16), per_volume(gain, at(f.volume)), own), d, to + n);
  }

  // Over the edges, their exchange times the difference of what is beyond them.
  HWY_INLINE V exchanged(const float* x, const float* y, const double* of) const {
    const V own = at(of);
    const V along_x = at(x) * (at(of, 1) - own) + at(x, -1) * (at(of, -1) - own);
    const V along_y = at(y) * (at(of, f.row) - own) + at(y, -f.row) * (at(of, -f.row) - own);
    return along_x + along_y;
  }
  HWY_INLINE void exchange(double rate, double mobility_all) const {
    const V v = at(f.volume), smooth = at(f.even), mean = at(f.mean);
    const V passed = smooth + per_volume(exchanged(f.strain_x, f.strain_y, f.even), v);
    hn::StoreU((mean + mean) - passed, d, f.mean + n);
    const V own = hn::Set(d, f.rate ? rate : rate * mobility_all) * at(f.potential), capacity = f.rate ? v * at(f.rate) : v;
    hn::StoreU(own + per_volume(exchanged(f.flow_x, f.flow_y, f.potential), capacity), d, f.change + n);
  }
};

std::size_t take_range(const PoreSumsView& sums, const PoreFields& f, const PoreEdges& edges, const std::uint32_t* nodes, std::size_t size,
                       std::uint32_t* special) {
  std::size_t found = 0;
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR {
    const auto inside = FromSums<decltype(d)>{d, sums, f, edges, n}.take();
    if (HWY_LIKELY(hn::AllTrue(d, inside))) return;
    double is_inside[hn::MaxLanes(decltype(d)())];
    hn::StoreU(hn::IfThenElseZero(inside, hn::Set(d, 1.0)), d, is_inside);
    for (std::size_t l = 0; l < hn::Lanes(d); ++l)
      if (!(is_inside[l] > 0)) special[found++] = std::uint32_t(n) + std::uint32_t(l);
  });
  return found;
}
void weigh_range(const PoreFields& f, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { AtNodes<decltype(d)>{d, f, n}.weigh(); });
}
void smooth_range(const PoreFields& f, const double* from, double* to, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR { AtNodes<decltype(d)>{d, f, n}.smooth(from, to); });
}
void exchange_range(const PoreFields& f, double rate, double mobility_all, const std::uint32_t* nodes, std::size_t size) {
  for_runs<8>(nodes, size, [&](auto d, std::ptrdiff_t n) HWY_ATTR {
    AtNodes<decltype(d)>{d, f, n}.exchange(rate, mobility_all);
  });
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::mpm {

HWY_EXPORT(take_range);
HWY_EXPORT(weigh_range);
HWY_EXPORT(smooth_range);
HWY_EXPORT(exchange_range);

std::size_t take_means_lanes(const PoreSumsView& sums, const PoreFields& f, const PoreEdges& edges, const std::uint32_t* nodes,
                             std::size_t size, std::uint32_t* special) {
  return HWY_DYNAMIC_DISPATCH(take_range)(sums, f, edges, nodes, size, special);
}
void weigh_elements_lanes(const PoreFields& f, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(weigh_range)(f, nodes, size);
}
void smooth_pores_lanes(const PoreFields& f, const double* from, double* to, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(smooth_range)(f, from, to, nodes, size);
}
void exchange_pores_lanes(const PoreFields& f, double rate, double mobility_all, const std::uint32_t* nodes, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(exchange_range)(f, rate, mobility_all, nodes, size);
}

}  // namespace pivnp::mpm
#endif

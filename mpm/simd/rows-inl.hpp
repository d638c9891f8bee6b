// Nodes that lie side by side in a row, as many at a time as a vector holds. Included by the kernels' sources inside
// Highway's loop over instruction sets.
#if defined(PIVNP_MPM_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_ROWS_INL
#undef PIVNP_MPM_ROWS_INL
#else
#define PIVNP_MPM_ROWS_INL
#endif

#include "mpm/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// Numbers of single precision in memory as vectors of doubles.
#if HWY_MAX_BYTES <= 16
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_single(Tag d, const float* p) {
  double lane[hn::MaxLanes(Tag())];
  for (std::size_t l = 0; l < hn::MaxLanes(Tag()); ++l) lane[l] = double(p[l]);
  return hn::LoadU(d, lane);
}
template <class Tag>
HWY_INLINE void store_single(hn::Vec<Tag> v, Tag d, float* p) {
  double lane[hn::MaxLanes(Tag())];
  hn::StoreU(v, d, lane);
  for (std::size_t l = 0; l < hn::MaxLanes(Tag()); ++l) p[l] = float(lane[l]);
}
#else
template <class Tag>
HWY_INLINE hn::Vec<Tag> load_single(Tag d, const float* p) {
  return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, Tag>(), p));
}
template <class Tag>
HWY_INLINE void store_single(hn::Vec<Tag> v, Tag, float* p) {
  const hn::Rebind<float, Tag> single;
  hn::StoreU(hn::DemoteTo(single, v), single, p);
}
#endif

// Calls body(tag, n) for the nodes of a list, n the first of as many as the tag has lanes, `most` at most; what a row
// has beyond those goes by fours, then one by one.
template <std::size_t most = 4, class Body>
HWY_INLINE void for_runs(const std::uint32_t* nodes, std::size_t size, Body&& body) {
  const auto in_row = [&](std::size_t k, std::size_t lanes)
                          HWY_ATTR { return k + lanes <= size && nodes[k + lanes - 1] == nodes[k] + (lanes - 1); };
  const hn::CappedTag<double, most> all;
  const hn::CappedTag<double, 4> four;
  const hn::CappedTag<double, 1> one;
  for (std::size_t k = 0; k < size;) {
    if (in_row(k, hn::Lanes(all))) {
      body(all, std::ptrdiff_t(nodes[k]));
      k += hn::Lanes(all);
      continue;
    }
    if constexpr (hn::MaxLanes(all) > 4)
      if (in_row(k, 4)) {
        body(four, std::ptrdiff_t(nodes[k]));
        k += 4;
        continue;
      }
    body(one, std::ptrdiff_t(nodes[k++]));
  }
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

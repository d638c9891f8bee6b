// Nodes that lie side by side in a row, as many at a time as a vector holds, four at most. Included by the kernels' sources
// inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_ROWS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_ROWS_INL
#undef PIVNP_MPM_ROWS_INL
#else
#define PIVNP_MPM_ROWS_INL
#endif

#include "mpm/simd/vectors-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

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

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

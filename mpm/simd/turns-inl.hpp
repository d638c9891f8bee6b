// Two numbers in turn over the lanes: loaded, and one of them taken to all lanes. Included by the kernels' sources
// inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_TURNS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_TURNS_INL
#undef PIVNP_MPM_TURNS_INL
#else
#define PIVNP_MPM_TURNS_INL
#endif

#include "mpm/simd/tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

#if HWY_MAX_BYTES <= 16
HWY_INLINE V load_in_turn(const double* a) {
  const hn::Half<D> h;
  return hn::Combine(D(), hn::LoadU(h, a), hn::LoadU(h, a));
}
HWY_INLINE V first_of_turn(V v) {
  return {hn::InterleaveLower(hn::Half<D>(), v.low, v.low), hn::InterleaveLower(hn::Half<D>(), v.high, v.high)};
}
HWY_INLINE V second_of_turn(V v) {
  return {hn::InterleaveUpper(hn::Half<D>(), v.low, v.low), hn::InterleaveUpper(hn::Half<D>(), v.high, v.high)};
}
#else
/// a[0], a[1], a[0], ...
HWY_INLINE V load_in_turn(const double* a) { return hn::LoadDup128(D(), a); }
HWY_INLINE V first_of_turn(V v) { return hn::DupEven(v); }
HWY_INLINE V second_of_turn(V v) { return hn::DupOdd(v); }
#endif
/// The same of two places, for the lanes of each group.
HWY_INLINE V load_in_turn(const double* first, [[maybe_unused]] const double* second) {
  if constexpr (groups == 1)
    return load_in_turn(first);
  else
    return hn::IfThenElse(hn::FirstN(D(), group_lanes), load_in_turn(first), load_in_turn(second));
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

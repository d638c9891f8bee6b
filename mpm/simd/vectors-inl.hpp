// The vector operations of this folder's kernels, as `hn`: Highway's own where a vector holds four doubles or more, else two
// of the compiler's as one of four (pairs.hpp). Included inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_VECTORS_INL
#undef PIVNP_MPM_VECTORS_INL
#else
#define PIVNP_MPM_VECTORS_INL
#endif

#include <hwy/highway.h>

#include "mpm/simd/pairs.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

#if HWY_MAX_BYTES <= 16
namespace hn = pairs;
constexpr bool in_pairs = true;
#else
namespace hn = hwy::HWY_NAMESPACE;
constexpr bool in_pairs = false;
#endif

inline const char* lanes_name() {
#if defined(__SSE2__) && HWY_MAX_BYTES <= 16
  return "SSE2";
#else
  return hwy::TargetName(HWY_TARGET);
#endif
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

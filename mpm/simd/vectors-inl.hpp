// The vector operations of this folder's kernels, as `hn`: Highway's own where a vector holds four doubles or more, else two
// of its vectors as one of four (pairs-inl.hpp). Its static target on x86-64 is scalar code with older compilers (no SSE2
// target before Highway 1.0.5, EMU128 not before GCC 12.3), though every such processor has SSE2; there sse2.hpp stands for
// it. Included inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_VECTORS_INL
#undef PIVNP_MPM_VECTORS_INL
#else
#define PIVNP_MPM_VECTORS_INL
#endif

#include <hwy/highway.h>

#include "mpm/simd/sse2.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// What a vector of the processor's holds.
#if (HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128) && defined(__SSE2__)
namespace native = sse2;
inline const char* lanes_name() { return "SSE2"; }
#else
namespace native = hwy::HWY_NAMESPACE;
inline const char* lanes_name() { return hwy::TargetName(HWY_TARGET); }
static_assert(HWY_HAVE_FLOAT64 && HWY_TARGET != HWY_SCALAR, "the kernels need vectors of two doubles");
#endif

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#include "mpm/simd/pairs-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

#if HWY_MAX_BYTES <= 16
namespace hn = pairs;
constexpr bool in_pairs = true;
#else
namespace hn = native;
constexpr bool in_pairs = false;
#endif

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// The vector operations of this folder's kernels, as `hn`: Highway's own where it has vectors. Its static target on x86-64 is
// scalar code with older compilers (no SSE2 target before Highway 1.0.5, EMU128 not before GCC 12.3), though every such
// processor has SSE2; there the same names stand for that. Included inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_VECTORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_VECTORS_INL
#undef PIVNP_MPM_VECTORS_INL
#else
#define PIVNP_MPM_VECTORS_INL
#endif

#include <hwy/highway.h>

#include "mpm/sse2.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

#if (HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128) && defined(__SSE2__)
namespace hn = sse2;
inline const char* lanes_name() { return "SSE2"; }
#else
namespace hn = hwy::HWY_NAMESPACE;
inline const char* lanes_name() { return hwy::TargetName(HWY_TARGET); }
static_assert(HWY_HAVE_FLOAT64 && HWY_TARGET != HWY_SCALAR, "the kernels need vectors of two doubles");
#endif

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

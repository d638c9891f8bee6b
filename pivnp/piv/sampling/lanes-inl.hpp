// The vector operations of this folder's kernels, as `hn`: Highway's own where it has vectors. Its static target on
// x86-64 is scalar code with older compilers (no SSE2 target before Highway 1.0.5, EMU128 not before GCC 12.3), though
// every such processor has SSE2; there the same names stand for that. Included inside Highway's loop over instruction
// sets.
#if defined(PIVNP_PIV_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_PIV_LANES_INL
#undef PIVNP_PIV_LANES_INL
#else
#define PIVNP_PIV_LANES_INL
#endif

#include <hwy/highway.h>

#if HWY_TARGET == HWY_SCALAR && defined(__SSE2__)

#include <emmintrin.h>

#include <cstddef>
#include <cstdint>

namespace pivnp::piv::HWY_NAMESPACE {
namespace sse2 {

struct Float4 {
  __m128 raw;
};
struct Int4 {
  __m128i raw;
};
struct Mask4 {
  __m128 raw;
};

struct IntTag {};
struct FloatTag {
  using Vector = Float4;
};
template <class T, std::size_t most>
requires(most >= 4) using CappedTag = FloatTag;
template <class D>
using Vec = typename D::Vector;
template <class V>
using DFromV = FloatTag;
template <class D>
using RebindToSigned = IntTag;

HWY_INLINE constexpr std::size_t Lanes(FloatTag) { return 4; }
HWY_INLINE Float4 Set(FloatTag, float x) { return {_mm_set1_ps(x)}; }
HWY_INLINE Float4 Zero(FloatTag) { return {_mm_setzero_ps()}; }
HWY_INLINE Float4 Iota(FloatTag, float x) { return {_mm_add_ps(_mm_set1_ps(x), _mm_setr_ps(0, 1, 2, 3))}; }
// Aligned or not: HWY_ALIGN aligns nothing for the scalar target.
HWY_INLINE Float4 LoadU(FloatTag, const float* p) { return {_mm_loadu_ps(p)}; }
HWY_INLINE Float4 Load(FloatTag, const float* p) { return {_mm_loadu_ps(p)}; }
HWY_INLINE void StoreU(Float4 v, FloatTag, float* p) { _mm_storeu_ps(p, v.raw); }
HWY_INLINE void Store(Float4 v, FloatTag, float* p) { _mm_storeu_ps(p, v.raw); }
HWY_INLINE void Store(Int4 v, IntTag, std::int32_t* p) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), v.raw); }

HWY_INLINE Float4 Add(Float4 a, Float4 b) { return {_mm_add_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 Sub(Float4 a, Float4 b) { return {_mm_sub_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 Mul(Float4 a, Float4 b) { return {_mm_mul_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 Div(Float4 a, Float4 b) { return {_mm_div_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 MulAdd(Float4 a, Float4 b, Float4 c) { return Add(Mul(a, b), c); }
HWY_INLINE Float4 NegMulAdd(Float4 a, Float4 b, Float4 c) { return Sub(c, Mul(a, b)); }
HWY_INLINE Float4 Min(Float4 a, Float4 b) { return {_mm_min_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 Max(Float4 a, Float4 b) { return {_mm_max_ps(a.raw, b.raw)}; }
HWY_INLINE Float4 Abs(Float4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.raw)}; }
HWY_INLINE Float4 Sqrt(Float4 a) { return {_mm_sqrt_ps(a.raw)}; }

HWY_INLINE Mask4 Eq(Float4 a, Float4 b) { return {_mm_cmpeq_ps(a.raw, b.raw)}; }
HWY_INLINE Mask4 Gt(Float4 a, Float4 b) { return {_mm_cmpgt_ps(a.raw, b.raw)}; }
HWY_INLINE Mask4 Le(Float4 a, Float4 b) { return {_mm_cmple_ps(a.raw, b.raw)}; }
HWY_INLINE Mask4 And(Mask4 a, Mask4 b) { return {_mm_and_ps(a.raw, b.raw)}; }
HWY_INLINE bool AllTrue(FloatTag, Mask4 m) { return _mm_movemask_ps(m.raw) == 15; }
HWY_INLINE Float4 IfThenElseZero(Mask4 m, Float4 a) { return {_mm_and_ps(m.raw, a.raw)}; }
HWY_INLINE Float4 IfThenZeroElse(Mask4 m, Float4 a) { return {_mm_andnot_ps(m.raw, a.raw)}; }
HWY_INLINE Float4 IfThenElse(Mask4 m, Float4 a, Float4 b) {
  return {_mm_or_ps(_mm_and_ps(m.raw, a.raw), _mm_andnot_ps(m.raw, b.raw))};
}

HWY_INLINE Int4 ConvertTo(IntTag, Float4 a) { return {_mm_cvttps_epi32(a.raw)}; }
HWY_INLINE Float4 Floor(Float4 a) {
  const Float4 whole{_mm_cvtepi32_ps(_mm_cvttps_epi32(a.raw))};
  const Float4 floor = Sub(whole, IfThenElseZero(Gt(whole, a), Float4{_mm_set1_ps(1)}));
  const Mask4 small = Gt(Float4{_mm_set1_ps(8388608)}, Abs(a));  // larger ones are whole; false for NaN
  return IfThenElse(small, floor, a);
}

HWY_INLINE float GetLane(Float4 a) { return _mm_cvtss_f32(a.raw); }
template <class Operation>
HWY_INLINE Float4 across(Float4 a, const Operation& operation) {
  const Float4 b = operation(a, Float4{_mm_shuffle_ps(a.raw, a.raw, _MM_SHUFFLE(1, 0, 3, 2))});
  return operation(b, Float4{_mm_shuffle_ps(b.raw, b.raw, _MM_SHUFFLE(2, 3, 0, 1))});
}
HWY_INLINE Float4 SumOfLanes(FloatTag, Float4 a) { return across(a, Add); }
HWY_INLINE Float4 MinOfLanes(FloatTag, Float4 a) { return across(a, Min); }
HWY_INLINE Float4 MaxOfLanes(FloatTag, Float4 a) { return across(a, Max); }

}  // namespace sse2

namespace hn = sse2;
inline const char* lanes_name() { return "SSE2"; }

}  // namespace pivnp::piv::HWY_NAMESPACE

#else

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
inline const char* lanes_name() { return hwy::TargetName(HWY_TARGET); }

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#endif  // PIVNP_PIV_LANES_INL

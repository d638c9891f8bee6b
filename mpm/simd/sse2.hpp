// Two doubles as every x86-64 processor has them (SSE2): names, order of operations and results of Highway's SSSE3, for
// where the library has scalar code only (vectors-inl.hpp). No more than pairs-inl.hpp uses.
#pragma once

#if defined(__SSE2__)

#include <emmintrin.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include <hwy/base.h>

namespace pivnp::mpm::sse2 {

// Both lanes, or (where a row ends) the lower one: the upper one then holds anything, and is neither loaded nor stored.
template <std::size_t lanes>
struct Tag {
  static_assert(lanes == 1 || lanes == 2);
};
struct Double2 {
  __m128d raw;
};
struct Mask2 {
  __m128d raw;  // all bits of a lane, or none
};

template <class T, std::size_t most>
using CappedTag = Tag<(most > 1 ? 2 : 1)>;
template <class D>
using Vec = Double2;
template <class D>
using Mask = Mask2;

template <std::size_t n>
HWY_INLINE constexpr std::size_t MaxLanes(Tag<n>) {
  return n;
}
template <std::size_t n>
HWY_INLINE constexpr std::size_t Lanes(Tag<n>) {
  return n;
}

// ---- Memory, aligned or not: HWY_ALIGN aligns nothing for the scalar target.
template <std::size_t n>
HWY_INLINE Double2 Set(Tag<n>, double x) {
  return {_mm_set1_pd(x)};
}
template <std::size_t n>
HWY_INLINE Double2 Zero(Tag<n>) {
  return {_mm_setzero_pd()};
}
template <std::size_t n>
HWY_INLINE Double2 Inf(Tag<n> d) {
  return Set(d, std::numeric_limits<double>::infinity());
}
HWY_INLINE Double2 LoadU(Tag<2>, const double* p) { return {_mm_loadu_pd(p)}; }
HWY_INLINE Double2 LoadU(Tag<1>, const double* p) { return {_mm_load_sd(p)}; }
HWY_INLINE Double2 Load(Tag<2>, const double* p) { return {_mm_loadu_pd(p)}; }
HWY_INLINE void StoreU(Double2 v, Tag<2>, double* p) { _mm_storeu_pd(p, v.raw); }
HWY_INLINE void StoreU(Double2 v, Tag<1>, double* p) { _mm_store_sd(p, v.raw); }
HWY_INLINE void Store(Double2 v, Tag<2>, double* p) { _mm_storeu_pd(p, v.raw); }
HWY_INLINE double GetLane(Double2 v) { return _mm_cvtsd_f64(v.raw); }

// ---- Lanes from two vectors; the lower one is the even one.
HWY_INLINE Double2 InterleaveLower(Tag<2>, Double2 a, Double2 b) { return {_mm_unpacklo_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 InterleaveUpper(Tag<2>, Double2 a, Double2 b) { return {_mm_unpackhi_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 OddEven(Double2 odd, Double2 even) { return {_mm_shuffle_pd(even.raw, odd.raw, 2)}; }
HWY_INLINE Double2 Reverse2(Tag<2>, Double2 v) { return {_mm_shuffle_pd(v.raw, v.raw, 1)}; }
HWY_INLINE Double2 Compress(Double2 v, Mask2 m) { return _mm_movemask_pd(m.raw) == 2 ? Double2{_mm_unpackhi_pd(v.raw, v.raw)} : v; }

HWY_INLINE void LoadInterleaved2(Tag<2> d, const double* p, Double2& a, Double2& b) {
  const Double2 low = LoadU(d, p), high = LoadU(d, p + 2);
  a = InterleaveLower(d, low, high);
  b = InterleaveUpper(d, low, high);
}
HWY_INLINE void LoadInterleaved2(Tag<1> d, const double* p, Double2& a, Double2& b) {
  a = LoadU(d, p);
  b = LoadU(d, p + 1);
}
HWY_INLINE void LoadInterleaved4(Tag<2> d, const double* p, Double2& a, Double2& b, Double2& c, Double2& e) {
  const Double2 ab = LoadU(d, p), ce = LoadU(d, p + 2), ab_next = LoadU(d, p + 4), ce_next = LoadU(d, p + 6);
  a = InterleaveLower(d, ab, ab_next);
  b = InterleaveUpper(d, ab, ab_next);
  c = InterleaveLower(d, ce, ce_next);
  e = InterleaveUpper(d, ce, ce_next);
}
HWY_INLINE void LoadInterleaved4(Tag<1> d, const double* p, Double2& a, Double2& b, Double2& c, Double2& e) {
  LoadInterleaved2(d, p, a, b);
  LoadInterleaved2(d, p + 2, c, e);
}
HWY_INLINE void StoreInterleaved2(Double2 a, Double2 b, Tag<2> d, double* p) {
  StoreU(InterleaveLower(d, a, b), d, p);
  StoreU(InterleaveUpper(d, a, b), d, p + 2);
}
HWY_INLINE void StoreInterleaved2(Double2 a, Double2 b, Tag<1> d, double* p) {
  StoreU(a, d, p);
  StoreU(b, d, p + 1);
}
HWY_INLINE void StoreInterleaved4(Double2 a, Double2 b, Double2 c, Double2 e, Tag<2> d, double* p) {
  StoreU(InterleaveLower(d, a, b), d, p);
  StoreU(InterleaveLower(d, c, e), d, p + 2);
  StoreU(InterleaveUpper(d, a, b), d, p + 4);
  StoreU(InterleaveUpper(d, c, e), d, p + 6);
}
HWY_INLINE void StoreInterleaved4(Double2 a, Double2 b, Double2 c, Double2 e, Tag<1> d, double* p) {
  StoreInterleaved2(a, b, d, p);
  StoreInterleaved2(c, e, d, p + 2);
}

// ---- Arithmetic; min and max are the second number where one of the two is not a number.
HWY_INLINE Double2 operator+(Double2 a, Double2 b) { return {_mm_add_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 operator-(Double2 a, Double2 b) { return {_mm_sub_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 operator*(Double2 a, Double2 b) { return {_mm_mul_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 operator/(Double2 a, Double2 b) { return {_mm_div_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 MulAdd(Double2 a, Double2 b, Double2 c) { return a * b + c; }
HWY_INLINE Double2 MulSub(Double2 a, Double2 b, Double2 c) { return a * b - c; }
HWY_INLINE Double2 NegMulAdd(Double2 a, Double2 b, Double2 c) { return c - a * b; }
HWY_INLINE Double2 Min(Double2 a, Double2 b) { return {_mm_min_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 Max(Double2 a, Double2 b) { return {_mm_max_pd(a.raw, b.raw)}; }
HWY_INLINE Double2 Sqrt(Double2 a) { return {_mm_sqrt_pd(a.raw)}; }
HWY_INLINE Double2 Neg(Double2 a) { return {_mm_xor_pd(a.raw, _mm_set1_pd(-0.0))}; }
HWY_INLINE Double2 Abs(Double2 a) { return {_mm_andnot_pd(_mm_set1_pd(-0.0), a.raw)}; }
HWY_INLINE Double2 SumOfLanes(Tag<2>, Double2 a) { return a + Double2{_mm_shuffle_pd(a.raw, a.raw, 1)}; }
HWY_INLINE Double2 MaxOfLanes(Tag<2>, Double2 a) { return Max(a, Double2{_mm_shuffle_pd(a.raw, a.raw, 1)}); }

// ---- Masks; what is not a number is unequal, and neither less nor greater.
HWY_INLINE Mask2 Eq(Double2 a, Double2 b) { return {_mm_cmpeq_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Ne(Double2 a, Double2 b) { return {_mm_cmpneq_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Lt(Double2 a, Double2 b) { return {_mm_cmplt_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Le(Double2 a, Double2 b) { return {_mm_cmple_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Gt(Double2 a, Double2 b) { return Lt(b, a); }
HWY_INLINE Mask2 Ge(Double2 a, Double2 b) { return Le(b, a); }
HWY_INLINE Mask2 And(Mask2 a, Mask2 b) { return {_mm_and_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 AndNot(Mask2 a, Mask2 b) { return {_mm_andnot_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Or(Mask2 a, Mask2 b) { return {_mm_or_pd(a.raw, b.raw)}; }
HWY_INLINE Mask2 Not(Mask2 a) { return {_mm_xor_pd(a.raw, _mm_castsi128_pd(_mm_set1_epi32(-1)))}; }
HWY_INLINE bool AllTrue(Tag<2>, Mask2 m) { return _mm_movemask_pd(m.raw) == 3; }
HWY_INLINE bool AllFalse(Tag<2>, Mask2 m) { return _mm_movemask_pd(m.raw) == 0; }
HWY_INLINE Double2 IfThenElseZero(Mask2 m, Double2 a) { return {_mm_and_pd(m.raw, a.raw)}; }
HWY_INLINE Double2 IfThenZeroElse(Mask2 m, Double2 a) { return {_mm_andnot_pd(m.raw, a.raw)}; }
HWY_INLINE Double2 IfThenElse(Mask2 m, Double2 a, Double2 b) {
  return {_mm_xor_pd(b.raw, _mm_and_pd(m.raw, _mm_xor_pd(a.raw, b.raw)))};  // (fewer copies than by and, and-not, or)
}
template <std::size_t n>
HWY_INLINE Mask2 FirstN(Tag<n>, std::size_t size) {
  return {_mm_cmplt_pd(_mm_setr_pd(0, 1), _mm_set1_pd(int(size < n ? size : n)))};
}
HWY_INLINE Mask2 LoadMaskBits(Tag<2>, const std::uint8_t* bits) {
  const long long low = bits[0] & 1, high = bits[0] >> 1 & 1;
  return {_mm_castsi128_pd(_mm_set_epi64x(-high, -low))};
}
// To the lowest bits of the first byte; the number of bytes.
HWY_INLINE std::size_t StoreMaskBits(Tag<2>, Mask2 m, std::uint8_t* bits) {
  bits[0] = std::uint8_t(_mm_movemask_pd(m.raw));
  return 1;
}

// ---- 2^k of the lower two of four integers.
HWY_INLINE Double2 power_of_two(__m128i k) {
  const __m128i biased = _mm_add_epi32(k, _mm_set1_epi32(1023));
  return {_mm_castsi128_pd(_mm_slli_epi64(_mm_unpacklo_epi32(_mm_setzero_si128(), biased), 20))};
}
// exp x for x <= 706, to the last bit or two; 0 below -1000 and for what is not a number. Highway's own
// (hwy/contrib/math), operation by operation.
HWY_INLINE Double2 Exp(Tag<2> d, Double2 x) {
  const Double2 half{_mm_or_pd(_mm_set1_pd(0.5), _mm_and_pd(x.raw, _mm_set1_pd(-0.0)))};
  const Double2 turns = Min(MulAdd(x, Set(d, 1.442695040888963407359924681), half), Set(d, 2147483647.0));
  const __m128i k = _mm_cvttpd_epi32(turns.raw), k_half = _mm_srai_epi32(k, 1);
  const Double2 whole{_mm_cvtepi32_pd(k)};
  Double2 r = MulAdd(whole, Set(d, -0.6931471805596629565116018), x);
  r = MulAdd(whole, Set(d, -0.28235290563031577122588448175e-12), r);
  const auto pair = [&](double low, double high) { return MulAdd(Set(d, high), r, Set(d, low)); };
  const Double2 r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
  const Double2 low = MulAdd(r2, pair(0.0416666666666665047591422, 0.00833333333331652721664984),
                             pair(0.5, 0.166666666666666851703837));
  const Double2 middle = MulAdd(r2, pair(2.4801587159235472998791e-5, 2.75572362911928827629423e-6),
                                pair(0.00138888888889774492207962, 0.000198412698960509205564975));
  const Double2 high = MulAdd(r2, Set(d, 2.08860621107283687536341e-9),
                              pair(2.75573911234900471893338e-7, 2.51112930892876518610661e-8));
  const Double2 series = MulAdd(r8, high, MulAdd(r4, middle, low));
  const Double2 y = MulAdd(series, r2, r) + Set(d, 1);
  const Double2 scaled = y * power_of_two(k_half) * power_of_two(_mm_sub_epi32(k, k_half));
  return IfThenElseZero(Ge(x, Set(d, -1000)), scaled);
}

}  // namespace pivnp::mpm::sse2

#endif  // __SSE2__

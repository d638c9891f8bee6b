// Four doubles as two of the compiler's vectors of two, with the names and the order of lanes of Highway's vectors of four: for
// processors whose own vectors hold no more than two (x86-64 without AVX2, and other families). A tile takes a cell's four
// points there too, and what is done once a tile or a cell is done half as often as with two lanes. No more than the
// kernels name, some of it in branches for other numbers of lanes. (Highway's own targets for such processors, SSSE3 and
// SSE4, are no faster than this, and plain x86-64 is scalar code with its release 1.0.3.)
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <hwy/base.h>

namespace pivnp::mpm::pairs {

typedef double Double2 __attribute__((vector_size(16)));
using Mask2 = decltype(Double2() < Double2());  // all bits of a lane, or none

struct Double4 {
  Double2 low, high;
};
struct Mask4 {
  Mask2 low, high;
};

template <std::size_t lanes>
struct Tag {
  static_assert(lanes == 1 || lanes == 2 || lanes == 4);
};
using Tag2 = Tag<2>;
using Tag4 = Tag<4>;

template <class D>
struct Of;
template <>
struct Of<Tag<1>> {  // for what is left at the end of a row
  using V = double;
  using M = bool;
};
template <>
struct Of<Tag2> {
  using V = Double2;
  using M = Mask2;
};
template <>
struct Of<Tag4> {
  using V = Double4;
  using M = Mask4;
};
template <class D>
using Vec = typename Of<D>::V;
template <class D>
using Mask = typename Of<D>::M;
template <class T, std::size_t most>
using CappedTag = Tag<(most >= 4 ? 4 : most >= 2 ? 2 : 1)>;
template <class D>
using Half = std::enable_if_t<std::is_same_v<D, Tag4>, Tag2>;

template <std::size_t n>
HWY_INLINE constexpr std::size_t MaxLanes(Tag<n>) {
  return n;
}
template <std::size_t n>
HWY_INLINE constexpr std::size_t Lanes(Tag<n>) {
  return n;
}

// ---- Memory, aligned or not.
HWY_INLINE double Set(Tag<1>, double x) { return x; }
HWY_INLINE Double2 Set(Tag2, double x) { return Double2{x, x}; }
HWY_INLINE Double4 Set(Tag4, double x) { return {Double2{x, x}, Double2{x, x}}; }
template <std::size_t n>
HWY_INLINE Vec<Tag<n>> Zero(Tag<n> d) {
  return Set(d, 0.0);
}
template <std::size_t n>
HWY_INLINE Vec<Tag<n>> Inf(Tag<n> d) {
  return Set(d, std::numeric_limits<double>::infinity());
}
HWY_INLINE Double2 LoadU(Tag2, const double* p) {
  Double2 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
HWY_INLINE double LoadU(Tag<1>, const double* p) { return *p; }
HWY_INLINE void StoreU(double v, Tag<1>, double* p) { *p = v; }
HWY_INLINE Double4 LoadU(Tag4, const double* p) { return {LoadU(Tag2(), p), LoadU(Tag2(), p + 2)}; }
HWY_INLINE Double4 Load(Tag4 d, const double* p) { return LoadU(d, p); }
HWY_INLINE void StoreU(Double2 v, Tag2, double* p) { std::memcpy(p, &v, sizeof v); }
HWY_INLINE void StoreU(Double4 v, Tag4, double* p) {
  StoreU(v.low, Tag2(), p);
  StoreU(v.high, Tag2(), p + 2);
}
HWY_INLINE void Store(Double4 v, Tag4 d, double* p) { StoreU(v, d, p); }
HWY_INLINE double GetLane(Double4 v) { return v.low[0]; }

// A bit a lane.
HWY_INLINE unsigned bits_of(Mask2 m) {
#if defined(__SSE2__)
  return unsigned(_mm_movemask_pd(reinterpret_cast<__m128d>(m)));
#else
  return unsigned((m[0] & 1) | (m[1] & 2));
#endif
}
// Another thread may write to the lanes that are left out.
HWY_INLINE void store_some(Double2 v, Mask2 m, double* p) {
  const unsigned bits = bits_of(m);
  if (bits == 3) return StoreU(v, Tag2(), p);
  if (bits & 1) p[0] = v[0];
  if (bits & 2) p[1] = v[1];
}
HWY_INLINE void BlendedStore(Double4 v, Mask4 m, Tag4, double* p) {
  store_some(v.low, m.low, p);
  store_some(v.high, m.high, p + 2);
}

// ---- Lanes from several vectors.
HWY_INLINE Double2 LowerHalf(Tag2, Double4 v) { return v.low; }
HWY_INLINE Double2 UpperHalf(Tag2, Double4 v) { return v.high; }
HWY_INLINE Double4 Combine(Tag4, Double2 high, Double2 low) { return {low, high}; }
HWY_INLINE Double2 InterleaveLower(Tag2, Double2 a, Double2 b) { return __builtin_shufflevector(a, b, 0, 2); }
HWY_INLINE Double2 InterleaveUpper(Tag2, Double2 a, Double2 b) { return __builtin_shufflevector(a, b, 1, 3); }
HWY_INLINE Double2 OddEven(Double2 odd, Double2 even) { return __builtin_shufflevector(even, odd, 0, 3); }
HWY_INLINE Double4 OddEven(Double4 odd, Double4 even) { return {OddEven(odd.low, even.low), OddEven(odd.high, even.high)}; }
HWY_INLINE Double4 ConcatLowerLower(Tag4, Double4 high, Double4 low) { return {low.low, high.low}; }
HWY_INLINE Double4 ConcatUpperUpper(Tag4, Double4 high, Double4 low) { return {low.high, high.high}; }
HWY_INLINE Double4 ConcatLowerUpper(Tag4, Double4 high, Double4 low) { return {low.high, high.low}; }
HWY_INLINE Double4 Reverse2(Tag4, Double4 v) {
  return {__builtin_shufflevector(v.low, v.low, 1, 0), __builtin_shufflevector(v.high, v.high, 1, 0)};
}
HWY_INLINE Double4 OddEvenBlocks(Double4 odd, Double4 even) { return {even.low, odd.high}; }
HWY_INLINE Double4 SwapAdjacentBlocks(Double4 v) { return {v.high, v.low}; }
HWY_INLINE Double4 Compress(Double4 v, Mask4 m) {
  double lane[4] = {};
  std::size_t n = 0;
  for (const auto& [of, bits] : {std::pair{v.low, bits_of(m.low)}, std::pair{v.high, bits_of(m.high)}})
    for (int l = 0; l < 2; ++l)
      if (bits >> l & 1) lane[n++] = of[l];
  return LoadU(Tag4(), lane);
}

HWY_INLINE void LoadInterleaved2(Tag<1>, const double* p, double& a, double& b) {
  a = p[0];
  b = p[1];
}
HWY_INLINE void LoadInterleaved4(Tag<1>, const double* p, double& a, double& b, double& c, double& e) {
  LoadInterleaved2(Tag<1>(), p, a, b);
  LoadInterleaved2(Tag<1>(), p + 2, c, e);
}
HWY_INLINE void StoreInterleaved2(double a, double b, Tag<1>, double* p) {
  p[0] = a;
  p[1] = b;
}
HWY_INLINE void StoreInterleaved4(double a, double b, double c, double e, Tag<1> d, double* p) {
  StoreInterleaved2(a, b, d, p);
  StoreInterleaved2(c, e, d, p + 2);
}
HWY_INLINE void LoadInterleaved2(Tag4, const double* p, Double4& a, Double4& b) {
  const Double4 first = LoadU(Tag4(), p), second = LoadU(Tag4(), p + 4);
  a = {InterleaveLower(Tag2(), first.low, first.high), InterleaveLower(Tag2(), second.low, second.high)};
  b = {InterleaveUpper(Tag2(), first.low, first.high), InterleaveUpper(Tag2(), second.low, second.high)};
}
HWY_INLINE void LoadInterleaved4(Tag4 d, const double* p, Double4& a, Double4& b, Double4& c, Double4& e) {
  const Double4 lane[] = {LoadU(d, p), LoadU(d, p + 4), LoadU(d, p + 8), LoadU(d, p + 12)};
  a = {InterleaveLower(Tag2(), lane[0].low, lane[1].low), InterleaveLower(Tag2(), lane[2].low, lane[3].low)};
  b = {InterleaveUpper(Tag2(), lane[0].low, lane[1].low), InterleaveUpper(Tag2(), lane[2].low, lane[3].low)};
  c = {InterleaveLower(Tag2(), lane[0].high, lane[1].high), InterleaveLower(Tag2(), lane[2].high, lane[3].high)};
  e = {InterleaveUpper(Tag2(), lane[0].high, lane[1].high), InterleaveUpper(Tag2(), lane[2].high, lane[3].high)};
}
HWY_INLINE void StoreInterleaved2(Double4 a, Double4 b, Tag4 d, double* p) {
  StoreU({InterleaveLower(Tag2(), a.low, b.low), InterleaveUpper(Tag2(), a.low, b.low)}, d, p);
  StoreU({InterleaveLower(Tag2(), a.high, b.high), InterleaveUpper(Tag2(), a.high, b.high)}, d, p + 4);
}
HWY_INLINE void StoreInterleaved4(Double4 a, Double4 b, Double4 c, Double4 e, Tag4 d, double* p) {
  StoreU({InterleaveLower(Tag2(), a.low, b.low), InterleaveLower(Tag2(), c.low, e.low)}, d, p);
  StoreU({InterleaveUpper(Tag2(), a.low, b.low), InterleaveUpper(Tag2(), c.low, e.low)}, d, p + 4);
  StoreU({InterleaveLower(Tag2(), a.high, b.high), InterleaveLower(Tag2(), c.high, e.high)}, d, p + 8);
  StoreU({InterleaveUpper(Tag2(), a.high, b.high), InterleaveUpper(Tag2(), c.high, e.high)}, d, p + 12);
}

// ---- Lane by lane; min and max are the second number where one of the two is not a number.
HWY_INLINE Double2 root(Double2 a) {
#if defined(__SSE2__)
  return _mm_sqrt_pd(a);
#else
  return Double2{std::sqrt(a[0]), std::sqrt(a[1])};
#endif
}
HWY_INLINE double Sqrt(double a) { return std::sqrt(a); }
HWY_INLINE double Neg(double a) { return -a; }
HWY_INLINE double Max(double a, double b) { return a > b ? a : b; }
HWY_INLINE double Min(double a, double b) { return a < b ? a : b; }
HWY_INLINE double MulAdd(double a, double b, double c) { return a * b + c; }
HWY_INLINE double NegMulAdd(double a, double b, double c) { return c - a * b; }
HWY_INLINE Double4 operator+(Double4 a, Double4 b) { return {a.low + b.low, a.high + b.high}; }
HWY_INLINE Double4 operator-(Double4 a, Double4 b) { return {a.low - b.low, a.high - b.high}; }
HWY_INLINE Double4 operator*(Double4 a, Double4 b) { return {a.low * b.low, a.high * b.high}; }
HWY_INLINE Double4 operator/(Double4 a, Double4 b) { return {a.low / b.low, a.high / b.high}; }
HWY_INLINE Double4 MulAdd(Double4 a, Double4 b, Double4 c) { return a * b + c; }
HWY_INLINE Double4 MulSub(Double4 a, Double4 b, Double4 c) { return a * b - c; }
HWY_INLINE Double4 NegMulAdd(Double4 a, Double4 b, Double4 c) { return c - a * b; }
HWY_INLINE Double4 Min(Double4 a, Double4 b) { return {a.low < b.low ? a.low : b.low, a.high < b.high ? a.high : b.high}; }
HWY_INLINE Double4 Max(Double4 a, Double4 b) { return {a.low > b.low ? a.low : b.low, a.high > b.high ? a.high : b.high}; }
HWY_INLINE Double4 Sqrt(Double4 a) { return {root(a.low), root(a.high)}; }
HWY_INLINE Double4 Neg(Double4 a) { return {-a.low, -a.high}; }
HWY_INLINE Double4 Abs(Double4 a) {
  constexpr std::int64_t all_but_sign = std::numeric_limits<std::int64_t>::max();
  return {reinterpret_cast<Double2>(reinterpret_cast<Mask2>(a.low) & all_but_sign),
          reinterpret_cast<Double2>(reinterpret_cast<Mask2>(a.high) & all_but_sign)};
}
HWY_INLINE Double4 Exp(Tag4, Double4 x) {
  return {Double2{std::exp(x.low[0]), std::exp(x.low[1])}, Double2{std::exp(x.high[0]), std::exp(x.high[1])}};
}

// ---- Masks; what is not a number is unequal, and neither less nor greater.
HWY_INLINE bool Gt(double a, double b) { return a > b; }
HWY_INLINE bool Le(double a, double b) { return a <= b; }
HWY_INLINE bool Ge(double a, double b) { return a >= b; }
HWY_INLINE bool And(bool a, bool b) { return a && b; }
HWY_INLINE bool AllTrue(Tag<1>, bool m) { return m; }
HWY_INLINE Mask4 Eq(Double4 a, Double4 b) { return {a.low == b.low, a.high == b.high}; }
HWY_INLINE Mask4 Ne(Double4 a, Double4 b) { return {a.low != b.low, a.high != b.high}; }
HWY_INLINE Mask4 Lt(Double4 a, Double4 b) { return {a.low < b.low, a.high < b.high}; }
HWY_INLINE Mask4 Le(Double4 a, Double4 b) { return {a.low <= b.low, a.high <= b.high}; }
HWY_INLINE Mask4 Gt(Double4 a, Double4 b) { return {a.low > b.low, a.high > b.high}; }
HWY_INLINE Mask4 Ge(Double4 a, Double4 b) { return {a.low >= b.low, a.high >= b.high}; }
HWY_INLINE Mask4 And(Mask4 a, Mask4 b) { return {a.low & b.low, a.high & b.high}; }
HWY_INLINE Mask4 AndNot(Mask4 a, Mask4 b) { return {~a.low & b.low, ~a.high & b.high}; }
HWY_INLINE Mask4 Or(Mask4 a, Mask4 b) { return {a.low | b.low, a.high | b.high}; }
HWY_INLINE Mask4 Not(Mask4 a) { return {~a.low, ~a.high}; }
HWY_INLINE bool AllTrue(Tag4, Mask4 m) { return bits_of(m.low & m.high) == 3; }
HWY_INLINE bool AllFalse(Tag4, Mask4 m) { return bits_of(m.low | m.high) == 0; }
HWY_INLINE double IfThenElse(bool m, double a, double b) { return m ? a : b; }
HWY_INLINE double IfThenElseZero(bool m, double a) { return m ? a : 0; }
HWY_INLINE double IfThenZeroElse(bool m, double a) { return m ? 0 : a; }
HWY_INLINE Double2 masked(Mask2 m, Double2 a) { return reinterpret_cast<Double2>(m & reinterpret_cast<Mask2>(a)); }
HWY_INLINE Double4 IfThenElse(Mask4 m, Double4 a, Double4 b) { return {m.low ? a.low : b.low, m.high ? a.high : b.high}; }
HWY_INLINE Double4 IfThenElseZero(Mask4 m, Double4 a) { return {masked(m.low, a.low), masked(m.high, a.high)}; }
HWY_INLINE Double4 IfThenZeroElse(Mask4 m, Double4 a) { return IfThenElseZero(Not(m), a); }
HWY_INLINE Mask4 FirstN(Tag4, std::size_t n) {
  const double size = n < 4 ? double(n) : 4;
  return Lt({Double2{0, 1}, Double2{2, 3}}, Set(Tag4(), size));
}
HWY_INLINE Mask4 LoadMaskBits(Tag4, const std::uint8_t* bits) {
  const std::int64_t b = bits[0];
  return {Mask2{-(b & 1), -(b >> 1 & 1)}, Mask2{-(b >> 2 & 1), -(b >> 3 & 1)}};
}

// ---- Over all lanes.
HWY_INLINE Double4 SumOfLanes(Tag4 d, Double4 a) {
  const Double2 sum = a.low + a.high;
  return Set(d, sum[0] + sum[1]);
}
HWY_INLINE Double4 MaxOfLanes(Tag4 d, Double4 a) {
  const Double2 most = a.low > a.high ? a.low : a.high;
  return Set(d, Max(most[0], most[1]));
}

}  // namespace pivnp::mpm::pairs

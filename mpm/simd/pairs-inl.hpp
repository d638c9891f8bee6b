// Four doubles as two vectors of two, with the names and the order of lanes of Highway's vectors of four, for processors whose
// own hold two: a tile then takes a cell's four points there too, and what is done once a tile or a cell is done half as
// often. An operation is that of the processor's vectors (`native`) on either half. No more than the kernels name, some of
// it in branches for other numbers of lanes. Included by vectors-inl.hpp.
#if defined(PIVNP_MPM_PAIRS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_PAIRS_INL
#undef PIVNP_MPM_PAIRS_INL
#else
#define PIVNP_MPM_PAIRS_INL
#endif

#include <cstddef>
#include <cstdint>
#include <type_traits>

#if HWY_MAX_BYTES <= 16

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE::pairs {

using Two = native::CappedTag<double, 2>;
using Vec2 = native::Vec<Two>;
using Mask2 = native::Mask<Two>;

struct Tag4 {};
struct Double4 {
  Vec2 low, high;
};
struct Mask4 {
  Mask2 low, high;
};

template <class D>
struct Of {
  using V = native::Vec<D>;
  using M = native::Mask<D>;
  using Half = Two;  // (a member, or nothing would depend on D: compilers would look at branches that are not taken)
};
template <>
struct Of<Tag4> {
  using V = Double4;
  using M = Mask4;
  using Half = Two;
};
template <class D>
using Vec = typename Of<D>::V;
template <class D>
using Mask = typename Of<D>::M;
template <class T, std::size_t most>
using CappedTag = std::conditional_t<(most >= 4), Tag4, native::CappedTag<T, (most < 2 ? most : 2)>>;
template <class D>
using Half = typename Of<D>::Half;

// The processor's own vectors, and single doubles, are what they are.
using native::Lanes;
using native::MaxLanes;
HWY_INLINE constexpr std::size_t MaxLanes(Tag4) { return 4; }
HWY_INLINE constexpr std::size_t Lanes(Tag4) { return 4; }

// ---- Memory.
using native::LoadU;
using native::Set;
using native::StoreU;
using native::Zero;
HWY_INLINE Double4 Set(Tag4, double x) {
  const Vec2 v = native::Set(Two(), x);
  return {v, v};
}
HWY_INLINE Double4 Zero(Tag4) { return {native::Zero(Two()), native::Zero(Two())}; }
HWY_INLINE Double4 Inf(Tag4) { return {native::Inf(Two()), native::Inf(Two())}; }
HWY_INLINE Double4 LoadU(Tag4, const double* p) { return {native::LoadU(Two(), p), native::LoadU(Two(), p + 2)}; }
HWY_INLINE Double4 Load(Tag4, const double* p) { return {native::Load(Two(), p), native::Load(Two(), p + 2)}; }
HWY_INLINE void StoreU(Double4 v, Tag4, double* p) {
  native::StoreU(v.low, Two(), p);
  native::StoreU(v.high, Two(), p + 2);
}
HWY_INLINE void Store(Double4 v, Tag4, double* p) {
  native::Store(v.low, Two(), p);
  native::Store(v.high, Two(), p + 2);
}
HWY_INLINE double GetLane(Double4 v) { return native::GetLane(v.low); }
// Another thread may write to the lanes that are left out.
HWY_INLINE void store_some(Vec2 v, Mask2 m, double* p) {
  std::uint8_t bits[8];
  native::StoreMaskBits(Two(), m, bits);
  if (bits[0] == 3) return native::StoreU(v, Two(), p);
  if (bits[0] & 1) p[0] = native::GetLane(v);
  if (bits[0] & 2) p[1] = native::GetLane(native::Reverse2(Two(), v));
}
HWY_INLINE void BlendedStore(Double4 v, Mask4 m, Tag4, double* p) {
  store_some(v.low, m.low, p);
  store_some(v.high, m.high, p + 2);
}

// ---- Lanes from several vectors.
HWY_INLINE Vec2 LowerHalf(Two, Double4 v) { return v.low; }
HWY_INLINE Vec2 UpperHalf(Two, Double4 v) { return v.high; }
HWY_INLINE Double4 Combine(Tag4, Vec2 high, Vec2 low) { return {low, high}; }
using native::OddEven;
using native::InterleaveLower;
using native::InterleaveUpper;
HWY_INLINE Double4 ConcatLowerLower(Tag4, Double4 high, Double4 low) { return {low.low, high.low}; }
HWY_INLINE Double4 ConcatUpperUpper(Tag4, Double4 high, Double4 low) { return {low.high, high.high}; }
HWY_INLINE Double4 Reverse2(Tag4, Double4 v) { return {native::Reverse2(Two(), v.low), native::Reverse2(Two(), v.high)}; }
HWY_INLINE Double4 OddEvenBlocks(Double4 odd, Double4 even) { return {even.low, odd.high}; }
HWY_INLINE Double4 SwapAdjacentBlocks(Double4 v) { return {v.high, v.low}; }
HWY_INLINE Double4 Compress(Double4 v, Mask4 m) {
  HWY_ALIGN double lane[4] = {};
  std::uint8_t low[8];
  native::StoreMaskBits(Two(), m.low, low);
  native::StoreU(native::Compress(v.low, m.low), Two(), lane);
  native::StoreU(native::Compress(v.high, m.high), Two(), lane + (low[0] & 1) + (low[0] >> 1 & 1));
  return LoadU(Tag4(), lane);
}
using native::LoadInterleaved2;
using native::LoadInterleaved4;
using native::StoreInterleaved2;
using native::StoreInterleaved4;
HWY_INLINE void LoadInterleaved2(Tag4, const double* p, Double4& a, Double4& b) {
  native::LoadInterleaved2(Two(), p, a.low, b.low);
  native::LoadInterleaved2(Two(), p + 4, a.high, b.high);
}
HWY_INLINE void LoadInterleaved4(Tag4, const double* p, Double4& a, Double4& b, Double4& c, Double4& e) {
  native::LoadInterleaved4(Two(), p, a.low, b.low, c.low, e.low);
  native::LoadInterleaved4(Two(), p + 8, a.high, b.high, c.high, e.high);
}
HWY_INLINE void StoreInterleaved2(Double4 a, Double4 b, Tag4, double* p) {
  native::StoreInterleaved2(a.low, b.low, Two(), p);
  native::StoreInterleaved2(a.high, b.high, Two(), p + 4);
}
HWY_INLINE void StoreInterleaved4(Double4 a, Double4 b, Double4 c, Double4 e, Tag4, double* p) {
  native::StoreInterleaved4(a.low, b.low, c.low, e.low, Two(), p);
  native::StoreInterleaved4(a.high, b.high, c.high, e.high, Two(), p + 8);
}

// ---- Lane by lane. (Those of single doubles are for what is left at the end of a row.)
#define PIVNP_ONE(Out, name, In) \
  HWY_INLINE Out name(In a) { return {native::name(a.low), native::name(a.high)}; }
#define PIVNP_TWO(Out, name, A, B) \
  HWY_INLINE Out name(A a, B b) { return {native::name(a.low, b.low), native::name(a.high, b.high)}; }
#define PIVNP_THREE(name, A) \
  HWY_INLINE Double4 name(A a, Double4 b, Double4 c) { return {native::name(a.low, b.low, c.low), native::name(a.high, b.high, c.high)}; }
using native::Gt;
using native::IfThenElse;
using native::IfThenElseZero;
using native::IfThenZeroElse;
using native::Le;
using native::Max;
using native::Neg;
using native::Sqrt;
HWY_INLINE Double4 operator+(Double4 a, Double4 b) { return {a.low + b.low, a.high + b.high}; }
HWY_INLINE Double4 operator-(Double4 a, Double4 b) { return {a.low - b.low, a.high - b.high}; }
HWY_INLINE Double4 operator*(Double4 a, Double4 b) { return {a.low * b.low, a.high * b.high}; }
HWY_INLINE Double4 operator/(Double4 a, Double4 b) { return {a.low / b.low, a.high / b.high}; }
PIVNP_THREE(MulAdd, Double4)
PIVNP_THREE(MulSub, Double4)
PIVNP_THREE(NegMulAdd, Double4)
PIVNP_TWO(Double4, Min, Double4, Double4)
PIVNP_TWO(Double4, Max, Double4, Double4)
PIVNP_ONE(Double4, Sqrt, Double4)
PIVNP_ONE(Double4, Neg, Double4)
PIVNP_ONE(Double4, Abs, Double4)
PIVNP_TWO(Mask4, Eq, Double4, Double4)
PIVNP_TWO(Mask4, Ne, Double4, Double4)
PIVNP_TWO(Mask4, Lt, Double4, Double4)
PIVNP_TWO(Mask4, Le, Double4, Double4)
PIVNP_TWO(Mask4, Gt, Double4, Double4)
PIVNP_TWO(Mask4, Ge, Double4, Double4)
PIVNP_TWO(Mask4, And, Mask4, Mask4)
PIVNP_TWO(Mask4, AndNot, Mask4, Mask4)
PIVNP_TWO(Mask4, Or, Mask4, Mask4)
PIVNP_ONE(Mask4, Not, Mask4)
PIVNP_TWO(Double4, IfThenElseZero, Mask4, Double4)
PIVNP_TWO(Double4, IfThenZeroElse, Mask4, Double4)
PIVNP_THREE(IfThenElse, Mask4)
#undef PIVNP_ONE
#undef PIVNP_TWO
#undef PIVNP_THREE
HWY_INLINE Double4 SumOfLanes(Tag4, Double4 a) {
  const Vec2 sum = native::SumOfLanes(Two(), a.low + a.high);
  return {sum, sum};
}
HWY_INLINE Double4 MaxOfLanes(Tag4, Double4 a) {
  const Vec2 most = native::MaxOfLanes(Two(), native::Max(a.low, a.high));
  return {most, most};
}
HWY_INLINE bool AllTrue(Tag4, Mask4 m) { return native::AllTrue(Two(), native::And(m.low, m.high)); }
HWY_INLINE bool AllFalse(Tag4, Mask4 m) { return native::AllFalse(Two(), native::Or(m.low, m.high)); }
HWY_INLINE Mask4 FirstN(Tag4, std::size_t n) { return {native::FirstN(Two(), n), native::FirstN(Two(), n < 2 ? 0 : n - 2)}; }
HWY_INLINE Mask4 LoadMaskBits(Tag4, const std::uint8_t* bits) {
  const std::uint8_t low[8] = {std::uint8_t(bits[0] & 3)}, high[8] = {std::uint8_t(bits[0] >> 2 & 3)};
  return {native::LoadMaskBits(Two(), low), native::LoadMaskBits(Two(), high)};
}
// (For those who include Highway's.)
template <class Tag>
HWY_INLINE Double4 Exp(Tag, Double4 x) {
  const Half<Tag> d;
  return {Exp(d, x.low), Exp(d, x.high)};
}

}  // namespace pivnp::mpm::HWY_NAMESPACE::pairs
HWY_AFTER_NAMESPACE();

#endif  // HWY_MAX_BYTES <= 16
#endif

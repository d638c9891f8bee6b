// Series in lanes. Included by the kernels' and the laws' sources inside Highway's loop over instruction sets.
#if defined(PIVNP_MPM_SERIES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PIVNP_MPM_SERIES_INL
#undef PIVNP_MPM_SERIES_INL
#else
#define PIVNP_MPM_SERIES_INL
#endif

#include "mpm/simd/tiles-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::mpm::HWY_NAMESPACE {

// The first `n` terms; even and odd powers apart, which halves the chain of dependent operations.
template <int n, std::size_t size>
HWY_INLINE V polynomial(V x, const double (&c)[size]) {
  static_assert(n >= 3 && n <= int(size));
  const V x2 = x * x;
  constexpr int even_end = (n - 1) / 2 * 2, odd_end = (n - 2) / 2 * 2 + 1;
  V even = set(c[even_end]), odd = set(c[odd_end]);
  for (int k = even_end - 2; k >= 0; k -= 2) even = hn::MulAdd(even, x2, set(c[k]));
  for (int k = odd_end - 2; k >= 1; k -= 2) odd = hn::MulAdd(odd, x2, set(c[k]));
  return hn::MulAdd(odd, x, even);
}

// 1/(1 + x) of |x| <= small_part, without a quotient: (1 - x)(1 + x^2)(1 + x^4 + x^8), which lacks x^12.
constexpr double small_part = 0.03;
HWY_INLINE V per_one_and(V x) {
  const V x2 = x * x, x4 = x2 * x2, low = set(1) - x, four = hn::MulAdd(low, x2, low);
  return hn::MulAdd(four, hn::MulAdd(x4, x4, x4), four);
}

}  // namespace pivnp::mpm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

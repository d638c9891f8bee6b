#include "pivnp/piv/sampling/prefilter.hpp"

#include <algorithm>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/sampling/prefilter.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

using D = hn::CappedTag<float, prefilter_lanes>;
using V = hn::Vec<D>;

// `vectors` side by side: independent recursions that hide each other's latency.
template <int vectors>
HWY_INLINE void filter_strip(float* data, int samples, std::ptrdiff_t stride, float smoothing) {
  constexpr float poles[] = {-0.430575347099973f, -0.0430962882032647f};
  constexpr float gain = 120.0f;  // product of (1 - z)(1 - 1/z) over the poles
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto at = [&](int k, int n) { return data + k * stride + n * lanes; };
  const V side = hn::Set(d, smoothing * gain), middle = hn::Set(d, (1 - 2 * smoothing) * gain);
  V previous[vectors], now[vectors];
  for (int n = 0; n < vectors; ++n) previous[n] = hn::LoadU(d, at(1, n)), now[n] = hn::LoadU(d, at(0, n));
  for (int k = 0; k < samples; ++k)
    for (int n = 0; n < vectors; ++n) {
      // Behind the last sample the mirror shows the one before it, already kept in `previous`.
      const V next = k + 1 < samples ? hn::LoadU(d, at(k + 1, n)) : previous[n];
      hn::StoreU(hn::MulAdd(middle, now[n], hn::Mul(side, hn::Add(previous[n], next))), d, at(k, n));
      previous[n] = now[n], now[n] = next;
    }
  for (const float z : poles) {
    constexpr int horizon = 20;  // |z|^20 < 5e-8
    const V factor = hn::Set(d, z);
    for (int n = 0; n < vectors; ++n) now[n] = hn::LoadU(d, at(0, n));
    float power = z;
    for (int k = 1; k < std::min(samples, horizon); ++k, power *= z)
      for (int n = 0; n < vectors; ++n) now[n] = hn::MulAdd(hn::Set(d, power), hn::LoadU(d, at(k, n)), now[n]);
    for (int n = 0; n < vectors; ++n) hn::StoreU(now[n], d, at(0, n)), previous[n] = now[n];
    for (int k = 1; k < samples; ++k)
      for (int n = 0; n < vectors; ++n) {
        previous[n] = now[n];
        now[n] = hn::MulAdd(factor, now[n], hn::LoadU(d, at(k, n)));
        hn::StoreU(now[n], d, at(k, n));
      }
    const V last = hn::Set(d, z / (z * z - 1));
    for (int n = 0; n < vectors; ++n) {
      now[n] = hn::Mul(last, hn::MulAdd(factor, previous[n], now[n]));
      hn::StoreU(now[n], d, at(samples - 1, n));
    }
    for (int k = samples - 2; k >= 0; --k)
      for (int n = 0; n < vectors; ++n) {
        now[n] = hn::Mul(factor, hn::Sub(now[n], hn::LoadU(d, at(k, n))));
        hn::StoreU(now[n], d, at(k, n));
      }
  }
}

void filter_lines(float* data, int samples, std::ptrdiff_t stride, int lanes, float smoothing) {
  const int vector = static_cast<int>(hn::Lanes(D()));
  int l = 0;
  for (; lanes - l >= 4 * vector; l += 4 * vector) filter_strip<4>(data + l, samples, stride, smoothing);
  for (; lanes - l >= 2 * vector; l += 2 * vector) filter_strip<2>(data + l, samples, stride, smoothing);
  for (; l < lanes; l += vector) filter_strip<1>(data + l, samples, stride, smoothing);
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(filter_lines);

void prefilter_lines(float* data, int samples, std::ptrdiff_t stride, int lanes, float smoothing) {
  if (samples < 2) return;  // a single sample: a constant line, whose coefficients are its values
  HWY_DYNAMIC_DISPATCH(filter_lines)(data, samples, stride, lanes, smoothing);
}

namespace {

using Four = float __attribute__((vector_size(16), aligned(4), may_alias));

// Four columns of four rows.
inline void transpose_four(const float* in, std::ptrdiff_t in_stride, float* out, std::ptrdiff_t out_stride) {
  const auto load = [&](int k) { return *reinterpret_cast<const Four*>(in + k * in_stride); };
  const auto store = [&](int k, Four v) { *reinterpret_cast<Four*>(out + k * out_stride) = v; };
  const Four a = load(0), b = load(1), c = load(2), d = load(3);
  const Four ab_low = __builtin_shufflevector(a, b, 0, 4, 1, 5), ab_high = __builtin_shufflevector(a, b, 2, 6, 3, 7),
             cd_low = __builtin_shufflevector(c, d, 0, 4, 1, 5), cd_high = __builtin_shufflevector(c, d, 2, 6, 3, 7);
  store(0, __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5));
  store(1, __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7));
  store(2, __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5));
  store(3, __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7));
}

}  // namespace

void transpose_rows(const float* image, std::ptrdiff_t stride, int rows, int columns, int lanes, float* lines) {
  for (int c = 0; c < columns; c += 4)
    for (int r = 0; r < rows; r += 4) transpose_four(image + r * stride + c, stride, lines + c * lanes + r, lanes);
}

void transpose_back(const float* lines, int lanes, int rows, int columns, std::ptrdiff_t stride, float* image) {
  for (int r = 0; r < rows; r += 4)
    for (int c = 0; c < columns; c += 4) transpose_four(lines + c * lanes + r, lanes, image + r * stride + c, stride);
}

}  // namespace pivnp::piv
#endif

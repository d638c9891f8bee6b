#include "pivnp/piv/window_kernels.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/window_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

HWY_INLINE float total(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

template <bool with_mask>
HWY_INLINE CutSums cut_rows(const WindowCut& in) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d)), columns = padded_columns(in.side), end = in.end_row;
  const std::ptrdiff_t source_stride = in.source_stride, stride = in.stride;
  const float* const wx = in.wx;
  const std::ptrdiff_t skipped = in.first_row * source_stride;
  V sum = hn::Zero(d), sum_f = sum, sum_g = sum, sum_masked = sum;
  const float *f = in.f + skipped, *g = in.g + skipped, *use = in.use + skipped;
  const float* masked = with_mask ? in.masked + skipped : nullptr;
  for (int r = in.first_row; r < end; ++r, f += source_stride, g += source_stride, use += source_stride) {
    const V wy = hn::Set(d, in.wy[r]);
    for (int k = 0; k < columns; k += lanes) {
      const V full = hn::Mul(wy, hn::LoadU(d, wx + k)), v = hn::Mul(full, hn::LoadU(d, use + k));
      const V square = hn::Mul(v, v);
      sum = hn::Add(sum, square);
      sum_f = hn::MulAdd(square, hn::LoadU(d, f + k), sum_f);
      sum_g = hn::MulAdd(square, hn::LoadU(d, g + k), sum_g);
      if constexpr (with_mask) sum_masked = hn::MulAdd(hn::Mul(full, full), hn::LoadU(d, masked + k), sum_masked);
    }
    if constexpr (with_mask) masked += source_stride;
  }
  CutSums out{.weight = total(sum), .f = total(sum_f), .g = total(sum_g), .masked = total(sum_masked)};
  const V mean_f = hn::Set(d, out.weight > 0 ? out.f / out.weight : 0.0f),
          mean_g = hn::Set(d, out.weight > 0 ? out.g / out.weight : 0.0f);
  V energy_a = hn::Zero(d), energy_b = energy_a;
  float *a = in.a, *b = in.b, *w = in.weight;
  f = in.f, g = in.g, use = in.use;
  for (int r = 0; r < in.side; ++r, a += stride, b += stride, w += stride) {
    if (r < in.first_row || r >= end) {
      for (float* line : {a, b, w}) std::fill(line, line + columns, 0.0f);
    } else {
      const V wy = hn::Set(d, in.wy[r]);
      for (int k = 0; k < columns; k += lanes) {
        const V v = hn::Mul(hn::Mul(wy, hn::LoadU(d, wx + k)), hn::LoadU(d, use + k));
        const V x = hn::Mul(v, hn::Sub(hn::LoadU(d, f + k), mean_f)),
                y = hn::Mul(v, hn::Sub(hn::LoadU(d, g + k), mean_g));
        hn::StoreU(x, d, a + k);
        hn::StoreU(y, d, b + k);
        hn::StoreU(v, d, w + k);
        energy_a = hn::MulAdd(x, x, energy_a);
        energy_b = hn::MulAdd(y, y, energy_b);
      }
    }
    f += source_stride, g += source_stride, use += source_stride;
  }
  out.energy_a = total(energy_a), out.energy_b = total(energy_b);
  return out;
}

CutSums cut(const WindowCut& in) { return in.masked != nullptr ? cut_rows<true>(in) : cut_rows<false>(in); }

float taper_line(float first, int side, float* out) {
  const D d;
  const float scale = 2 / static_cast<float>(side);
  V squares = hn::Zero(d);
  for (int k = 0; k < padded_columns(side); k += static_cast<int>(hn::Lanes(d))) {
    const V u = hn::Mul(hn::Set(d, scale), hn::Add(hn::Set(d, first), hn::Iota(d, static_cast<float>(k))));
    const V rest = hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1.0f), hn::Mul(u, u)));
    hn::StoreU(hn::Sqrt(rest), d, out + k);
    squares = hn::Add(squares, rest);
  }
  return total(squares);
}

template <int reach>
HWY_INLINE void lag_sums(const float* a, const float* b, int side, std::ptrdiff_t stride,
                         float (*c)[2 * near_lags + 1]) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const std::ptrdiff_t count = (side - 1) * stride + side;
  for (int sy = -reach; sy <= reach; ++sy) {
    const float* shifted = b + sy * stride;
    V sum[2 * reach + 1];
    for (V& s : sum) s = hn::Zero(d);
    for (std::ptrdiff_t k = 0; k < count; k += lanes) {
      const V first = hn::LoadU(d, a + k);
      for (int sx = -reach; sx <= reach; ++sx)
        sum[sx + reach] = hn::MulAdd(first, hn::LoadU(d, shifted + k + sx), sum[sx + reach]);
    }
    for (int sx = -reach; sx <= reach; ++sx) c[sy + near_lags][sx + near_lags] = total(sum[sx + reach]);
  }
}

void lags(const float* a, const float* b, int side, std::ptrdiff_t stride, int reach, float (*c)[2 * near_lags + 1]) {
  reach == 1 ? lag_sums<1>(a, b, side, stride, c) : lag_sums<near_lags>(a, b, side, stride, c);
}

FlankSums flanks(const float* a, const float* b, const float* w, int side, std::ptrdiff_t stride, float* scratch) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d)), columns = padded_columns(side),
            wide = padded_columns(side + flank_span);
  constexpr int before = 16;  // zeros before a line
  const int line = wide + 2 * before;
  std::fill(scratch, scratch + 14 * line, 0.0f);
  float* dx = scratch + before;
  float* dy = dx + line;
  const auto sums_x = [&](int slot) { return scratch + (2 + slot) * line + before; };
  const auto sums_y = [&](int slot) { return scratch + (2 + flank_span + slot) * line + before; };
  V xx = hn::Zero(d), yy = xx, xy = xx, slope_x = xx, slope_y = xx;
  for (int r = 0; r < side + flank_span - 1; ++r) {
    float* sx = sums_x(r % flank_span);
    float* sy = sums_y(r % flank_span);
    if (r < side) {
      const float* p = a + r * stride;
      const float* q = b + r * stride;
      for (int k = 0; k < columns; k += lanes) {
        const V p0 = hn::LoadU(d, p + k), q0 = hn::LoadU(d, q + k), v = hn::LoadU(d, w + r * stride + k);
        const V px = hn::LoadU(d, p + k + 1), qx = hn::LoadU(d, q + k + 1);
        const V py = hn::LoadU(d, p + k + stride), qy = hn::LoadU(d, q + k + stride);
        hn::StoreU(hn::Sub(hn::Mul(p0, qx), hn::Mul(px, q0)), d, dx + k);
        hn::StoreU(hn::Sub(hn::Mul(p0, qy), hn::Mul(py, q0)), d, dy + k);
        const V gx = hn::Mul(v, hn::Sub(px, hn::LoadU(d, p + k - 1))),
                gy = hn::Mul(v, hn::Sub(py, hn::LoadU(d, p + k - stride)));
        slope_x = hn::MulAdd(gx, gx, slope_x);
        slope_y = hn::MulAdd(gy, gy, slope_y);
      }
      for (int k = 0; k < wide; k += lanes) {
        V x = hn::LoadU(d, dx + k), y = hn::LoadU(d, dy + k);
        for (int m = 1; m < flank_span; ++m)
          x = hn::Add(x, hn::LoadU(d, dx + k - m)), y = hn::Add(y, hn::LoadU(d, dy + k - m));
        hn::StoreU(x, d, sx + k);
        hn::StoreU(y, d, sy + k);
      }
    } else {
      std::fill(sx, sx + wide, 0.0f);
      std::fill(sy, sy + wide, 0.0f);
    }
    for (int k = 0; k < wide; k += lanes) {
      V x = hn::LoadU(d, sums_x(0) + k), y = hn::LoadU(d, sums_y(0) + k);
      for (int m = 1; m < flank_span; ++m)
        x = hn::Add(x, hn::LoadU(d, sums_x(m) + k)), y = hn::Add(y, hn::LoadU(d, sums_y(m) + k));
      xx = hn::MulAdd(x, x, xx);
      yy = hn::MulAdd(y, y, yy);
      xy = hn::MulAdd(x, y, xy);
    }
  }
  return {total(xx), total(yy), total(xy), total(slope_x), total(slope_y)};
}

}  // namespace pivnp::piv::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pivnp::piv {

HWY_EXPORT(taper_line);
HWY_EXPORT(cut);
HWY_EXPORT(lags);
HWY_EXPORT(flanks);

float taper_weights(float first, int side, float* out) { return HWY_DYNAMIC_DISPATCH(taper_line)(first, side, out); }

CutSums cut_window(const WindowCut& in) { return HWY_DYNAMIC_DISPATCH(cut)(in); }

void near_sums(const float* a, const float* b, int side, std::ptrdiff_t stride, int reach,
               float (*c)[2 * near_lags + 1]) {
  HWY_DYNAMIC_DISPATCH(lags)(a, b, side, stride, reach, c);
}

FlankSums flank_sums(const float* a, const float* b, const float* w, int side, std::ptrdiff_t stride, float* scratch) {
  return HWY_DYNAMIC_DISPATCH(flanks)(a, b, w, side, stride, scratch);
}

}  // namespace pivnp::piv
#endif

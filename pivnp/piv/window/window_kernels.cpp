#include "pivnp/piv/window/window_kernels.hpp"

#include <algorithm>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pivnp/piv/window/window_kernels.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>

#include "pivnp/piv/sampling/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pivnp::piv::HWY_NAMESPACE {

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

HWY_INLINE float total(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

// Columns k ... k + vectors lanes - 1 of all rows: what the means need. `whole`: every pixel may be used.
template <int vectors, bool whole, bool with_mask>
HWY_INLINE void add_moments(const WindowCut& in, int k, CutSums& out) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  V wx[vectors], sum[vectors], sum_f[vectors], sum_g[vectors], sum_masked[vectors];
  for (int n = 0; n < vectors; ++n) {
    const V w = hn::LoadU(d, in.wx + k + n * lanes);
    wx[n] = hn::Mul(w, w);
    sum[n] = sum_f[n] = sum_g[n] = sum_masked[n] = hn::Zero(d);
  }
  std::ptrdiff_t at = in.first_row * in.source_stride + k;
  for (int r = in.first_row; r < in.end_row; ++r, at += in.source_stride) {
    const V wy = hn::Set(d, in.wy[r] * in.wy[r]);
    for (int n = 0; n < vectors; ++n) {
      const std::ptrdiff_t from = at + n * lanes;
      V w = wy;
      if constexpr (!whole) {
        const V use = hn::LoadU(d, in.use + from);
        w = hn::Mul(w, use);
        sum[n] = hn::Add(sum[n], w);
      }
      sum_f[n] = hn::MulAdd(w, hn::LoadU(d, in.f + from), sum_f[n]);
      sum_g[n] = hn::MulAdd(w, hn::LoadU(d, in.g + from), sum_g[n]);
      if constexpr (with_mask) sum_masked[n] = hn::MulAdd(wy, hn::LoadU(d, in.masked + from), sum_masked[n]);
    }
  }
  V all = hn::Zero(d), f = all, g = all, masked = all;
  for (int n = 0; n < vectors; ++n) {
    all = hn::MulAdd(wx[n], sum[n], all);
    f = hn::MulAdd(wx[n], sum_f[n], f);
    g = hn::MulAdd(wx[n], sum_g[n], g);
    masked = hn::MulAdd(wx[n], sum_masked[n], masked);
  }
  if constexpr (!whole) out.weight += total(all);
  if constexpr (with_mask) out.masked += total(masked);
  out.f += total(f), out.g += total(g);
}

// The same columns freed of the means and weighted.
template <int vectors, bool whole>
HWY_INLINE void write_columns(const WindowCut& in, int k, float mean_f, float mean_g, CutSums& out) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V mf = hn::Set(d, mean_f), mg = hn::Set(d, mean_g);
  V wx[vectors], energy_a[vectors], energy_b[vectors];
  for (int n = 0; n < vectors; ++n)
    wx[n] = hn::LoadU(d, in.wx + k + n * lanes), energy_a[n] = energy_b[n] = hn::Zero(d);
  std::ptrdiff_t at = in.first_row * in.source_stride + k, to = in.first_row * in.stride + k;
  for (int r = in.first_row; r < in.end_row; ++r, at += in.source_stride, to += in.stride) {
    const V wy = hn::Set(d, in.wy[r]);
    for (int n = 0; n < vectors; ++n) {
      const std::ptrdiff_t from = at + n * lanes, into = to + n * lanes;
      V v = hn::Mul(wy, wx[n]);
      if constexpr (!whole) v = hn::Mul(v, hn::LoadU(d, in.use + from));
      const V x = hn::Mul(v, hn::Sub(hn::LoadU(d, in.f + from), mf)),
              y = hn::Mul(v, hn::Sub(hn::LoadU(d, in.g + from), mg));
      hn::StoreU(x, d, in.a + into);
      hn::StoreU(y, d, in.b + into);
      if (in.weight != nullptr) hn::StoreU(v, d, in.weight + into);
      energy_a[n] = hn::MulAdd(x, x, energy_a[n]);
      energy_b[n] = hn::MulAdd(y, y, energy_b[n]);
    }
  }
  for (int n = 1; n < vectors; ++n)
    energy_a[0] = hn::Add(energy_a[0], energy_a[n]), energy_b[0] = hn::Add(energy_b[0], energy_b[n]);
  out.energy_a += total(energy_a[0]), out.energy_b += total(energy_b[0]);
}

// Calls work(number of vectors, first column) on blocks of columns that the registers hold.
template <class Work>
HWY_INLINE void by_columns(int columns, const Work& work) {
  const int lanes = static_cast<int>(hn::Lanes(D()));
  int k = 0;
  for (; columns - k >= 3 * lanes; k += 3 * lanes) work(std::integral_constant<int, 3>(), k);
  for (; columns - k >= 2 * lanes; k += 2 * lanes) work(std::integral_constant<int, 2>(), k);
  for (; k < columns; k += lanes) work(std::integral_constant<int, 1>(), k);
}

template <bool whole, bool with_mask>
HWY_INLINE CutSums cut_rows(const WindowCut& in) {
  const int columns = padded_columns(in.side);
  CutSums out{};
  by_columns(columns, [&](auto vectors, int k)
                          HWY_ATTR { add_moments<decltype(vectors)::value, whole, with_mask>(in, k, out); });
  if constexpr (whole) out.weight = in.whole_weight;
  const float mean_f = out.weight > 0 ? out.f / out.weight : 0.0f, mean_g = out.weight > 0 ? out.g / out.weight : 0.0f;
  for (int r = 0; r < in.side; ++r) {
    if (r >= in.first_row && r < in.end_row) continue;
    for (float* plane : {in.a, in.b, in.weight})
      if (plane != nullptr) std::fill_n(plane + r * in.stride, columns, 0.0f);
  }
  by_columns(columns, [&](auto vectors, int k)
                          HWY_ATTR { write_columns<decltype(vectors)::value, whole>(in, k, mean_f, mean_g, out); });
  return out;
}

CutSums cut(const WindowCut& in) {
  if (in.whole) return cut_rows<true, false>(in);
  return in.masked != nullptr ? cut_rows<false, true>(in) : cut_rows<false, false>(in);
}

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

// Lags of first ... last rows and all columns up to `reach`, in one sweep.
template <int reach, int first, int last>
HWY_INLINE void lag_sums(const float* a, const float* b, int side, std::ptrdiff_t stride,
                         float (*c)[2 * near_lags + 1]) {
  const D d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const std::ptrdiff_t count = (side - 1) * stride + side;
  constexpr int across = 2 * reach + 1;
  V sum[last - first + 1][across];
  for (auto& row : sum)
    for (V& s : row) s = hn::Zero(d);
  for (std::ptrdiff_t k = 0; k < count; k += lanes) {
    const V here = hn::LoadU(d, a + k);
    for (int sy = first; sy <= last; ++sy)
      for (int sx = -reach; sx <= reach; ++sx) {
        V& s = sum[sy - first][sx + reach];
        s = hn::MulAdd(here, hn::LoadU(d, b + sy * stride + k + sx), s);
      }
  }
  for (int sy = first; sy <= last; ++sy)
    for (int sx = -reach; sx <= reach; ++sx) c[sy + near_lags][sx + near_lags] = total(sum[sy - first][sx + reach]);
}

void lags(const float* a, const float* b, int side, std::ptrdiff_t stride, int reach, float (*c)[2 * near_lags + 1]) {
  static_assert(near_lags == 2);
  if (reach == 1) return lag_sums<1, -1, 1>(a, b, side, stride, c);
  lag_sums<2, -2, -1>(a, b, side, stride, c);  // more sums than that do not stay in registers everywhere
  lag_sums<2, 0, 1>(a, b, side, stride, c);
  lag_sums<2, 2, 2>(a, b, side, stride, c);
}

FlankSums flanks(const float* a, const float* b, const float* w, int side, std::ptrdiff_t stride, float* scratch) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d)), columns = padded_columns(side);
  const FlankScratch size(side);
  float* const sums_x = scratch + FlankScratch::before;  // over the five rows that end in this one
  float* const sums_y = sums_x + size.plane();
  static_assert(flank_span == 5);
  V slope_x = hn::Zero(d), slope_y = slope_x;
  for (int k = 0; k < columns; k += lanes) {  // down a strip of columns, the last rows in registers
    const float* p = a + k;
    const float* q = b + k;
    V above = hn::LoadU(d, p - stride), p0 = hn::LoadU(d, p), q0 = hn::LoadU(d, q);
    V dx1 = hn::Zero(d), dx2 = dx1, dx3 = dx1, dx4 = dx1, dy1 = dx1, dy2 = dx1, dy3 = dx1, dy4 = dx1;
    float *to_x = sums_x + k, *to_y = sums_y + k;
    for (int r = 0; r < size.rows; ++r, to_x += size.line, to_y += size.line) {
      V dx = hn::Zero(d), dy = dx;
      if (r < side) {
        const V v = hn::LoadU(d, w + r * stride + k);
        p += stride, q += stride;
        const V px = hn::LoadU(d, p - stride + 1), qx = hn::LoadU(d, q - stride + 1);
        const V py = hn::LoadU(d, p), qy = hn::LoadU(d, q);
        dx = hn::Sub(hn::Mul(p0, qx), hn::Mul(px, q0));
        dy = hn::Sub(hn::Mul(p0, qy), hn::Mul(py, q0));
        const V gx = hn::Mul(v, hn::Sub(px, hn::LoadU(d, p - stride - 1))), gy = hn::Mul(v, hn::Sub(py, above));
        slope_x = hn::MulAdd(gx, gx, slope_x);
        slope_y = hn::MulAdd(gy, gy, slope_y);
        above = p0, p0 = py, q0 = qy;
      }
      hn::StoreU(hn::Add(hn::Add(dx, dx1), hn::Add(hn::Add(dx2, dx3), dx4)), d, to_x);
      hn::StoreU(hn::Add(hn::Add(dy, dy1), hn::Add(hn::Add(dy2, dy3), dy4)), d, to_y);
      dx4 = dx3, dx3 = dx2, dx2 = dx1, dx1 = dx;
      dy4 = dy3, dy3 = dy2, dy2 = dy1, dy1 = dy;
    }
  }
  V xx = hn::Zero(d), yy = xx, xy = xx;
  const auto along = [&](const float* at) HWY_ATTR {  // over the five columns that end in this one
    return hn::Add(hn::Add(hn::LoadU(d, at), hn::LoadU(d, at - 1)),
                   hn::Add(hn::Add(hn::LoadU(d, at - 2), hn::LoadU(d, at - 3)), hn::LoadU(d, at - 4)));
  };
  for (int r = 0; r < size.rows; ++r)
    for (int k = 0; k < side + flank_span - 1; k += lanes) {
      const V x = along(sums_x + r * size.line + k), y = along(sums_y + r * size.line + k);
      xx = hn::MulAdd(x, x, xx);
      yy = hn::MulAdd(y, y, yy);
      xy = hn::MulAdd(x, y, xy);
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

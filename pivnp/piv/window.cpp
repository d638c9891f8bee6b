#include "pivnp/piv/window.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::piv {

namespace {

float axis_weight(float distance, float side) {
  const float u = 2 * distance / side, rest = 1 - u * u;
  if (rest <= 0) return 0;
  return taper == 1.0f ? std::sqrt(rest) : std::pow(rest, 0.5f * taper);
}

}  // namespace

Window::Window(int side_px)
    : side(side_px),
      stride((side_px + 2 * near_lags + 3) / 4 * 4),
      axis_x_(std::size_t(side_px)),
      axis_y_(std::size_t(side_px)) {
  const std::size_t size = std::size_t(stride) * std::size_t(side + 2 * near_lags);
  a.assign(size, 0.0f);
  b.assign(size, 0.0f);
  weight.assign(size, 0.0f);
}

void Window::cut(const WarpedPair& pair, float column, float row) {
  const auto length = static_cast<float>(side);
  const int x0 = static_cast<int>(std::ceil(column - 0.5f * length)),
            y0 = static_cast<int>(std::ceil(row - 0.5f * length));
  float whole_x = 0, whole_y = 0;
  for (int k = 0; k < side; ++k) {
    axis_x_[std::size_t(k)] = axis_weight(static_cast<float>(x0 + k) - column, length);
    axis_y_[std::size_t(k)] = axis_weight(static_cast<float>(y0 + k) - row, length);
    whole_x += axis_x_[std::size_t(k)] * axis_x_[std::size_t(k)];
    whole_y += axis_y_[std::size_t(k)] * axis_y_[std::size_t(k)];
  }
  const int first = std::max(0, pair.box.x0 - x0), end = std::min(side, pair.box.x1 - x0);
  float sum = 0, sum_f = 0, sum_g = 0, sum_masked = 0;
  for (int r = 0; r < side; ++r) {
    float* w = weight.data() + index(0, r);
    float* fa = a.data() + index(0, r);
    float* gb = b.data() + index(0, r);
    if (y0 + r < pair.box.y0 || y0 + r >= pair.box.y1 || first >= end) {
      std::fill(w, w + side, 0.0f);
      std::fill(fa, fa + side, 0.0f);
      std::fill(gb, gb + side, 0.0f);
      continue;
    }
    std::fill(w, w + first, 0.0f);
    std::fill(w + end, w + side, 0.0f);
    const std::size_t at = pair.index(x0 + first, y0 + r);
    const float* f = pair.f.data() + at;
    const float* g = pair.g.data() + at;
    const PixelUse* use = pair.use.data() + at;
    const float wy = axis_y_[std::size_t(r)];
    const float* wx = axis_x_.data();
#pragma omp simd reduction(+ : sum, sum_f, sum_g, sum_masked)
    for (int k = first; k < end; ++k) {
      const float full = wx[k] * wy;
      const float v = use[k - first] == PixelUse::usable ? full : 0.0f;
      w[k] = v;
      fa[k] = f[k - first];
      gb[k] = g[k - first];
      sum += v * v;
      sum_f += v * v * fa[k];
      sum_g += v * v * gb[k];
      sum_masked += use[k - first] == PixelUse::masked ? full * full : 0.0f;
    }
  }
  const float whole = whole_x * whole_y;
  usable = whole > 0 ? sum / whole : 0.0f;
  masked = whole > 0 ? sum_masked / whole : 0.0f;
  outside = std::max(0.0f, 1 - usable - masked);
  energy_a = energy_b = 0;
  const float mean_f = sum > 0 ? sum_f / sum : 0.0f, mean_g = sum > 0 ? sum_g / sum : 0.0f;
  for (int r = 0; r < side; ++r) {
    const float* w = weight.data() + index(0, r);
    float* fa = a.data() + index(0, r);
    float* gb = b.data() + index(0, r);
    float ea = 0, eb = 0;
#pragma omp simd reduction(+ : ea, eb)
    for (int k = 0; k < side; ++k) {
      fa[k] = w[k] * (fa[k] - mean_f);
      gb[k] = w[k] * (gb[k] - mean_g);
      ea += fa[k] * fa[k];
      eb += gb[k] * gb[k];
    }
    energy_a += ea, energy_b += eb;
  }
  variance_f = sum > 0 ? energy_a / sum : 0.0f;
  variance_g = sum > 0 ? energy_b / sum : 0.0f;
}

std::vector<float> taper_correlation(int side, int count) {
  std::vector<double> w(static_cast<std::size_t>(side));
  for (int k = 0; k < side; ++k)
    w[std::size_t(k)] =
        axis_weight(static_cast<float>(k) - 0.5f * static_cast<float>(side - 1), static_cast<float>(side));
  std::vector<float> share(static_cast<std::size_t>(count));
  double whole = 0;
  for (int lag = 0; lag < count; ++lag) {
    double sum = 0;
    for (int k = 0; k + lag < side; ++k) sum += w[std::size_t(k)] * w[std::size_t(k + lag)];
    if (lag == 0) whole = sum;
    share[std::size_t(lag)] = static_cast<float>(sum / whole);
  }
  return share;
}

}  // namespace pivnp::piv

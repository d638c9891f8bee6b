#include "pivnp/piv/uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "pivnp/piv/subpixel.hpp"

namespace pivnp::piv {

UncertaintyEstimator::UncertaintyEstimator(int side)
    : side_(side),
      stride_(side + 2 * span),
      dx_(std::size_t(stride_) * std::size_t(stride_)),
      dy_(dx_.size()),
      line_(std::size_t(stride_)) {}

float iteration_variance(int passes) { return passes <= 1 ? 1.0f : passes == 2 ? 1.6f : 2.0f; }

// Replaces d by its sums over span x span pixels ending at each place.
void UncertaintyEstimator::box_sums(std::vector<float>& d) {
  const int n = side_ + span;  // sums are zero beyond
  std::fill(line_.begin(), line_.begin() + span, 0.0f);
  for (int r = 0; r < n; ++r) {
    float* row = d.data() + std::ptrdiff_t(r) * stride_;
    std::copy(row, row + n, line_.begin() + span);
    for (int k = 1; k < span; ++k) {
      const float* before = line_.data() + span - k;
      for (int c = 0; c < n; ++c) row[c] += before[c];
    }
  }
  for (int r = n - 1; r >= 0; --r)
    for (int k = 1; k < span && k <= r; ++k) {
      float* to = d.data() + std::ptrdiff_t(r) * stride_;
      const float* from = d.data() + std::ptrdiff_t(r - k) * stride_;
      for (int c = 0; c < n; ++c) to[c] += from[c];
    }
}

std::array<float, 3> UncertaintyEstimator::covariance(const Window& window, const Peak& peak, float rounding_variance) {
  std::fill(dx_.begin(), dx_.end(), 0.0f);
  std::fill(dy_.begin(), dy_.end(), 0.0f);
  const float energy = std::sqrt(window.energy_a) * std::sqrt(window.energy_b);
  const float scale = energy > 0 ? 1 / energy : 0.0f;
  float slope_x = 0, slope_y = 0;  // sums of w^2 times the squared central difference of the texture
  for (int r = 0; r < side_; ++r) {
    const float* a = window.a.data() + window.index(0, r);
    const float* b = window.b.data() + window.index(0, r);
    const float* w = window.weight.data() + window.index(0, r);
    float* dx = dx_.data() + std::ptrdiff_t(r) * stride_;
    float* dy = dy_.data() + std::ptrdiff_t(r) * stride_;
    const int below = window.stride;
#pragma omp simd reduction(+ : slope_x, slope_y)
    for (int k = 0; k < side_; ++k) {
      dx[k] = scale * (a[k] * b[k + 1] - a[k + 1] * b[k]);
      dy[k] = scale * (a[k] * b[k + below] - a[k + below] * b[k]);
      const float gx = a[k + 1] - a[k - 1], gy = a[k + below] - a[k - below];
      slope_x += w[k] * w[k] * gx * gx;
      slope_y += w[k] * w[k] * gy * gy;
    }
  }
  box_sums(dx_);
  box_sums(dy_);
  float xx = 0, yy = 0, xy = 0;
  const std::ptrdiff_t count = std::ptrdiff_t(stride_) * (side_ + span);
  const float *x = dx_.data(), *y = dy_.data();
#pragma omp simd reduction(+ : xx, yy, xy)
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    xx += x[k] * x[k];
    yy += y[k] * y[k];
    xy += x[k] * y[k];
  }
  constexpr float bartlett = 1.0f / (span * span);
  const float rounding = window.energy_a > 0 ? 2 * rounding_variance / (window.energy_a * window.energy_a) : 0.0f;
  const float kx = three_point_sensitivity(peak.around[1][0], peak.around[1][1], peak.around[1][2]);
  const float ky = three_point_sensitivity(peak.around[0][1], peak.around[1][1], peak.around[2][1]);
  return {kx * kx * std::max(bartlett * xx, rounding * slope_x), ky * ky * std::max(bartlett * yy, rounding * slope_y),
          kx * ky * bartlett * xy};
}

}  // namespace pivnp::piv

#include "pivnp/piv/correlate.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <mutex>
#include <stdexcept>

#include <fftw3.h>

#include "pivnp/piv/subpixel.hpp"

namespace pivnp::piv {

namespace {

std::mutex planner;  // FFTW's planner is not thread-safe; executing plans is

// The search's whole-lag peak to a fraction: one three-point fit an axis.
template <class Correlation>
void refine(const Correlation& c, int sx, int sy, Peak& peak) {
  const float middle = c(sx, sy);
  peak.dx = static_cast<float>(sx) + three_point_peak(c(sx - 1, sy), middle, c(sx + 1, sy));
  peak.dy = static_cast<float>(sy) + three_point_peak(c(sx, sy - 1), middle, c(sx, sy + 1));
  peak.score = std::clamp(middle, -1.0f, 1.0f);
  peak.interior = true;
}

float inverse_norm(const Window& window) {
  const float energy = std::sqrt(window.energy_a) * std::sqrt(window.energy_b);
  return energy > 0 ? 1 / energy : 0.0f;
}

}  // namespace

NearCorrelator::NearCorrelator(int side) : taper_share_(taper_correlation(side, near_lags + 1)) {}

Peak NearCorrelator::find(const Window& window) const {
  constexpr int lags = 2 * near_lags + 1;
  float c[lags][lags];
  const float scale = inverse_norm(window);
  // The border of zeros lets both windows be read as one line: what a lag carries across a row's end meets a zero.
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(window.index(0, 0));
  const std::ptrdiff_t count = std::ptrdiff_t(window.side - 1) * window.stride + window.side;
  const float* a = window.a.data() + first;
  for (int sy = -near_lags; sy <= near_lags; ++sy) {
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, -sy) * window.stride;
    const std::ptrdiff_t to = count - std::max<std::ptrdiff_t>(0, sy) * window.stride;
    const float* b = window.b.data() + first + sy * window.stride;
    float s0 = 0, s1 = 0, s2 = 0, s3 = 0, s4 = 0;
#pragma omp simd reduction(+ : s0, s1, s2, s3, s4)
    for (std::ptrdiff_t k = from; k < to; ++k) {
      s0 += a[k] * b[k - 2];
      s1 += a[k] * b[k - 1];
      s2 += a[k] * b[k];
      s3 += a[k] * b[k + 1];
      s4 += a[k] * b[k + 2];
    }
    const float sums[lags] = {s0, s1, s2, s3, s4};
    for (int sx = 0; sx < lags; ++sx)
      c[sy + near_lags][sx] = sums[sx] * scale /
                              (taper_share_[std::size_t(std::abs(sx - near_lags))] * taper_share_[std::size_t(std::abs(sy))]);
  }
  Peak peak;
  int bx = 0, by = 0;
  for (int y = 0; y < lags; ++y)
    for (int x = 0; x < lags; ++x)
      if (c[y][x] > c[by][bx]) bx = x, by = y;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) peak.around[y][x] = c[y + near_lags - 1][x + near_lags - 1];
  if (bx == 0 || by == 0 || bx == lags - 1 || by == lags - 1) {
    peak.dx = static_cast<float>(bx - near_lags), peak.dy = static_cast<float>(by - near_lags);
    peak.score = std::clamp(c[by][bx], -1.0f, 1.0f);
    return peak;
  }
  refine([&](int x, int y) { return c[y + near_lags][x + near_lags]; }, bx - near_lags, by - near_lags, peak);
  return peak;
}

// Buffers of one thread, and plans made for them.
struct FftCorrelator::Plan {
  explicit Plan(int side) {
    const std::size_t real = std::size_t(side) * std::size_t(side), half = std::size_t(side) * std::size_t(side / 2 + 1);
    a = fftwf_alloc_real(real), b = fftwf_alloc_real(real);
    fa = fftwf_alloc_complex(half), fb = fftwf_alloc_complex(half);
    if (!a || !b || !fa || !fb) throw std::bad_alloc();
    const std::lock_guard lock(planner);
    forward_a = fftwf_plan_dft_r2c_2d(side, side, a, fa, FFTW_ESTIMATE);
    forward_b = fftwf_plan_dft_r2c_2d(side, side, b, fb, FFTW_ESTIMATE);
    backward = fftwf_plan_dft_c2r_2d(side, side, fa, a, FFTW_ESTIMATE);
  }
  ~Plan() {
    const std::lock_guard lock(planner);
    for (fftwf_plan plan : {forward_a, forward_b, backward}) fftwf_destroy_plan(plan);
    fftwf_free(a), fftwf_free(b), fftwf_free(fa), fftwf_free(fb);
  }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  float *a = nullptr, *b = nullptr;
  fftwf_complex *fa = nullptr, *fb = nullptr;
  fftwf_plan forward_a{}, forward_b{}, backward{};
};

FftCorrelator::FftCorrelator(int side)
    : side_(side), taper_share_(taper_correlation(side, side / 3 + 2)), plan_(std::make_unique<Plan>(side)) {}
FftCorrelator::~FftCorrelator() = default;
FftCorrelator::FftCorrelator(FftCorrelator&&) noexcept = default;

Peak FftCorrelator::find(const Window& window) {
  const int n = side_, farthest = n / 3;
  for (int r = 0; r < n; ++r) {
    const std::size_t at = window.index(0, r);
    std::copy_n(window.a.data() + at, n, plan_->a + std::ptrdiff_t(r) * n);
    std::copy_n(window.b.data() + at, n, plan_->b + std::ptrdiff_t(r) * n);
  }
  fftwf_execute(plan_->forward_a);
  fftwf_execute(plan_->forward_b);
  const std::size_t half = std::size_t(n) * std::size_t(n / 2 + 1);
  for (std::size_t k = 0; k < half; ++k) {  // conj(A) B
    const float ar = plan_->fa[k][0], ai = plan_->fa[k][1], br = plan_->fb[k][0], bi = plan_->fb[k][1];
    plan_->fa[k][0] = ar * br + ai * bi;
    plan_->fa[k][1] = ar * bi - ai * br;
  }
  fftwf_execute(plan_->backward);

  const float scale = inverse_norm(window) / static_cast<float>(n * n);
  const auto c = [&](int sx, int sy) {
    const int x = sx < 0 ? sx + n : sx, y = sy < 0 ? sy + n : sy;
    return plan_->a[std::ptrdiff_t(y) * n + x] * scale /
           (taper_share_[std::size_t(std::abs(sx))] * taper_share_[std::size_t(std::abs(sy))]);
  };
  int bx = 0, by = 0;
  float best = c(0, 0);
  for (int sy = -farthest; sy <= farthest; ++sy)
    for (int sx = -farthest; sx <= farthest; ++sx)
      if (const float value = c(sx, sy); value > best) best = value, bx = sx, by = sy;
  Peak peak;
  refine(c, bx, by, peak);
  peak.interior = std::abs(bx) < farthest && std::abs(by) < farthest;
  return peak;
}

}  // namespace pivnp::piv

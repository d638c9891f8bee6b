#include "pivnp/piv/window/correlate.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "pivnp/piv/window/subpixel.hpp"

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
  float c[lags][lags] = {};
  const float scale = inverse_norm(window);
  const auto sum = [&](int reach) {
    near_sums(window.a.data() + window.index(0, 0), window.b.data() + window.index(0, 0), window.side, window.stride,
              reach, c);
  };
  const auto normalise = [&](int reach) {
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        c[y + near_lags][x + near_lags] *=
            scale / (taper_share_[std::size_t(std::abs(x))] * taper_share_[std::size_t(std::abs(y))]);
  };
  int bx = 0, by = 0;
  const auto find_largest = [&](int reach) {
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        if (c[y + near_lags][x + near_lags] > c[by + near_lags][bx + near_lags]) bx = x, by = y;
  };
  const auto at = [&](int x, int y) { return c[y + near_lags][x + near_lags]; };

  sum(1);
  normalise(1);
  find_largest(1);
  Peak peak;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) peak.around[y][x] = at(x - 1, y - 1);
  if (bx != 0 || by != 0) {  // not where the predictor says: look one farther
    sum(near_lags);
    normalise(near_lags);
    find_largest(near_lags);
  }
  if (std::max(std::abs(bx), std::abs(by)) == near_lags) {
    peak.dx = static_cast<float>(bx), peak.dy = static_cast<float>(by);
    peak.score = std::clamp(at(bx, by), -1.0f, 1.0f);
    return peak;
  }
  refine(at, bx, by, peak);
  return peak;
}

void NearCorrelator::add(const Window& window, float* plane) const {
  constexpr int lags = 2 * near_lags + 1;
  float c[lags][lags] = {};
  near_sums(window.a.data() + window.index(0, 0), window.b.data() + window.index(0, 0), window.side, window.stride,
            near_lags, c);
  const float scale = inverse_norm(window);
  for (int y = 0; y < lags; ++y)
    for (int x = 0; x < lags; ++x)
      plane[y * lags + x] +=
          c[y][x] * scale /
          (taper_share_[std::size_t(std::abs(x - near_lags))] * taper_share_[std::size_t(std::abs(y - near_lags))]);
}

Peak NearCorrelator::peak_of(const float* plane, int count) {
  constexpr int lags = 2 * near_lags + 1;
  const float share = 1 / static_cast<float>(count);
  const auto at = [&](int x, int y) { return share * plane[(y + near_lags) * lags + x + near_lags]; };
  int bx = 0, by = 0;
  for (int y = -near_lags; y <= near_lags; ++y)
    for (int x = -near_lags; x <= near_lags; ++x)
      if (at(x, y) > at(bx, by)) bx = x, by = y;
  Peak peak;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) peak.around[y][x] = at(x - 1, y - 1);
  if (std::max(std::abs(bx), std::abs(by)) == near_lags) {
    peak.dx = static_cast<float>(bx), peak.dy = static_cast<float>(by);
    peak.score = std::clamp(at(bx, by), -1.0f, 1.0f);
    return peak;
  }
  refine(at, bx, by, peak);
  return peak;
}

// Buffers of one thread, and plans made for them: 2 x batch transforms forth, batch back, or those of a single pair.
struct FftCorrelator::Plan {
  explicit Plan(int side)
      : real(std::size_t(side) * std::size_t(side)), half(std::size_t(side) * std::size_t(side / 2 + 1)) {
    pixels = fftwf_alloc_real(2 * batch * real);
    spectra = fftwf_alloc_complex(2 * batch * half);
    if (!pixels || !spectra) throw std::bad_alloc();
    std::fill_n(pixels, 2 * batch * real, 0.0f);
    const std::lock_guard lock(planner);
    const int n[2] = {side, side}, whole = static_cast<int>(real), part = static_cast<int>(half);
    for (const int pairs : {1, batch}) {
      auto& [forward, backward] = pairs == 1 ? single : all;
      forward =
          fftwf_plan_many_dft_r2c(2, n, 2 * pairs, pixels, nullptr, 1, whole, spectra, nullptr, 1, part, FFTW_ESTIMATE);
      backward = fftwf_plan_many_dft_c2r(2, n, pairs, spectra, nullptr, 1, 2 * part, pixels, nullptr, 1, 2 * whole,
                                         FFTW_ESTIMATE);
    }
  }
  ~Plan() {
    const std::lock_guard lock(planner);
    for (const auto& [forward, backward] : {single, all}) fftwf_destroy_plan(forward), fftwf_destroy_plan(backward);
    fftwf_free(pixels), fftwf_free(spectra);
  }
  Plan(const Plan&) = delete;
  Plan& operator=(const Plan&) = delete;

  float* a(int slot) { return pixels + 2 * std::size_t(slot) * real; }
  float* b(int slot) { return a(slot) + real; }

  std::size_t real, half;            // numbers of a window, and of its spectrum
  float* pixels = nullptr;           // [slot][a, b][side][side]; after the transform back, a holds the correlation
  fftwf_complex* spectra = nullptr;  // [slot][a, b][side][side / 2 + 1]
  std::pair<fftwf_plan, fftwf_plan> single{}, all{};
};

namespace {

// Least even size from `least` up that has the factors 2, 3 and 5 only.
int quick_size(int least) {
  for (int n = least + least % 2;; n += 2) {
    int rest = n;
    for (const int factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return n;
  }
}

}  // namespace

FftCorrelator::FftCorrelator(int side)
    : side_(side), size_(quick_size(side)), scale_(batch, 0.0f), plan_(std::make_unique<Plan>(size_)) {
  const int most = side / 3 + 1;
  const std::vector<float> share = taper_correlation(side, most + 1);
  for (int lag = -most; lag <= most; ++lag) untaper_.push_back(1 / share[std::size_t(std::abs(lag))]);
}
FftCorrelator::~FftCorrelator() = default;
FftCorrelator::FftCorrelator(FftCorrelator&&) noexcept = default;

void FftCorrelator::put(int slot, const Window& window) {
  const int n = size_;
  for (const auto& [from, to] : {std::pair{&window.a, plan_->a(slot)}, {&window.b, plan_->b(slot)}}) {
    for (int r = 0; r < side_; ++r) {
      float* line = to + std::ptrdiff_t(r) * n;
      std::copy_n(from->data() + window.index(0, r), side_, line);
      std::fill(line + side_, line + n, 0.0f);
    }
    std::fill(to + std::ptrdiff_t(side_) * n, to + std::ptrdiff_t(n) * n, 0.0f);
  }
  scale_[std::size_t(slot)] = inverse_norm(window) / static_cast<float>(n * n);
}

void FftCorrelator::transform(int count) {
  const auto& [forward, backward] = count == 1 ? plan_->single : plan_->all;
  fftwf_execute(forward);
  for (int slot = 0; slot < count; ++slot) {
    float* a = &plan_->spectra[2 * std::size_t(slot) * plan_->half][0];
    const float* b = a + 2 * plan_->half;
#pragma omp simd
    for (std::size_t k = 0; k < plan_->half; ++k) {  // conj(A) B
      const float ar = a[2 * k], ai = a[2 * k + 1], br = b[2 * k], bi = b[2 * k + 1];
      a[2 * k] = ar * br + ai * bi;
      a[2 * k + 1] = ar * bi - ai * br;
    }
  }
  fftwf_execute(backward);
}

void FftCorrelator::find(int count, Peak* peaks) {
  transform(count);
  for (int slot = 0; slot < count; ++slot) peaks[slot] = peak_of(slot);
}

void FftCorrelator::add(int count, float* const* planes) {
  transform(count);
  const int n = size_, most = side_ / 3 + 1;
  const float* untaper = untaper_.data() + most;
  for (int slot = 0; slot < count; ++slot) {
    const float *correlation = plan_->a(slot), scale = scale_[std::size_t(slot)];
    float* to = planes[slot];
    for (int y = -most; y <= most; ++y)
      for (int x = -most; x <= most; ++x)
        *to++ +=
            correlation[std::ptrdiff_t(y < 0 ? y + n : y) * n + (x < 0 ? x + n : x)] * scale * untaper[x] * untaper[y];
  }
}

Peak FftCorrelator::peak_of(const float* plane, int count) const {
  const int farthest = side_ / 3, row = 2 * (farthest + 1) + 1;
  const float share = 1 / static_cast<float>(count);
  const auto c = [&](int x, int y) { return share * plane[(y + farthest + 1) * row + x + farthest + 1]; };
  int bx = 0, by = 0;
  for (int y = -farthest; y <= farthest; ++y)
    for (int x = -farthest; x <= farthest; ++x)
      if (c(x, y) > c(bx, by)) bx = x, by = y;
  Peak peak;
  refine(c, bx, by, peak);
  peak.interior = std::abs(bx) < farthest && std::abs(by) < farthest;
  return peak;
}

Peak FftCorrelator::find(const Window& window) {
  Peak peak;
  put(0, window);
  find(1, &peak);
  return peak;
}

Peak FftCorrelator::peak_of(int slot) const {
  const int n = size_, farthest = side_ / 3;
  const float* correlation = plan_->a(slot);
  const float* untaper = untaper_.data() + farthest + 1;
  const float scale = scale_[std::size_t(slot)];
  const auto c = [&](int sx, int sy) {
    const int x = sx < 0 ? sx + n : sx, y = sy < 0 ? sy + n : sy;
    return correlation[std::ptrdiff_t(y) * n + x] * scale * untaper[sx] * untaper[sy];
  };
  int bx = 0, by = 0;
  float best = c(0, 0);
  for (int sy = -farthest; sy <= farthest; ++sy) {
    const float* line = correlation + std::ptrdiff_t(sy < 0 ? sy + n : sy) * n;
    const float along_y = scale * untaper[sy];
    float most = 0;  // of the line: most lines hold no candidate
    for (int sx = 0; sx <= farthest; ++sx) most = std::max(most, line[sx] * untaper[sx]);
    for (int sx = -farthest; sx < 0; ++sx) most = std::max(most, line[sx + n] * untaper[sx]);
    if (!(most * along_y > best)) continue;
    for (int sx = -farthest; sx <= farthest; ++sx)
      if (const float value = c(sx, sy); value > best) best = value, bx = sx, by = sy;
  }
  Peak peak;
  refine(c, bx, by, peak);
  peak.interior = std::abs(bx) < farthest && std::abs(by) < farthest;
  return peak;
}

}  // namespace pivnp::piv

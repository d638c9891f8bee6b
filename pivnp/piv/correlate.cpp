#include "pivnp/piv/correlate.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <mutex>
#include <stdexcept>

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

// Buffers of one thread, and plans made for them.
struct FftCorrelator::Plan {
  explicit Plan(int side) {
    const std::size_t real = std::size_t(side) * std::size_t(side),
                      half = std::size_t(side) * std::size_t(side / 2 + 1);
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
    : side_(side),
      size_(quick_size(side)),
      taper_share_(taper_correlation(side, side / 3 + 2)),
      plan_(std::make_unique<Plan>(size_)) {}
FftCorrelator::~FftCorrelator() = default;
FftCorrelator::FftCorrelator(FftCorrelator&&) noexcept = default;

Peak FftCorrelator::find(const Window& window) {
  const int n = size_, farthest = side_ / 3;
  for (const auto& [from, to] : {std::pair{&window.a, plan_->a}, {&window.b, plan_->b}}) {
    for (int r = 0; r < side_; ++r) {
      float* line = to + std::ptrdiff_t(r) * n;
      std::copy_n(from->data() + window.index(0, r), side_, line);
      std::fill(line + side_, line + n, 0.0f);
    }
    std::fill(to + std::ptrdiff_t(side_) * n, to + std::ptrdiff_t(n) * n, 0.0f);
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

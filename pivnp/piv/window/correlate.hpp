// Cross-correlation of two windows, over all lags by FFT or over the nearest lags directly, and its peak.
#pragma once

#include <memory>
#include <vector>

#include "pivnp/piv/window/window.hpp"

namespace pivnp::piv {

/// Over all lags, or over the nearest only.
enum class Search { far, near };

/// Peak of the normalised cross-correlation c(s) = sum a(x) b(x + s) / (|a| |b| R(s)), R the taper's own correlation.
struct Peak {
  float dx = 0, dy = 0;     // lag with fraction, pixels of the level: the second window's content lies there
  float score = 0;          // c at the peak's whole lag, -1 .. 1
  bool interior = false;    // the peak lies inside the lags searched, not at their end
  float around[3][3] = {};  // c at lags -1 ... 1 about zero, [y][x] (near search only)
};

/// The nearest lags, summed directly: the finish, once a predictor has brought the windows together. A peak at lag zero
/// among -1 ... 1 is taken as it is; else -2 ... 2 are searched.
class NearCorrelator {
 public:
  explicit NearCorrelator(int side);
  Peak find(const Window& window) const;

  /// For the mean of several pairs: adds the correlation at lags -2 ... 2 to `plane` ([y][x]), of which peak_of() finds
  /// the peak of the mean of `count`.
  static constexpr int plane_size = (2 * near_lags + 1) * (2 * near_lags + 1);
  void add(const Window& window, float* plane) const;
  static Peak peak_of(const float* plane, int count);

 private:
  std::vector<float> taper_share_;
};

/// All lags up to a third of the side, by real FFT of the next size that is a product of 2, 3 and 5 (Willert & Gharib
/// 1991). The taper keeps what wraps around small. Windows are put in one by one and transformed together, `batch` of
/// them a plan. One object a thread; making one takes a lock (FFTW plans), using one does not.
class FftCorrelator {
 public:
  static constexpr int batch = 16;

  explicit FftCorrelator(int side);
  ~FftCorrelator();
  FftCorrelator(FftCorrelator&&) noexcept;
  /// Puts a window in place `slot` of the batch, 0 ... batch - 1.
  void put(int slot, const Window& window);
  /// Correlates the windows of the first `count` places.
  void find(int count, Peak* peaks);
  Peak find(const Window& window);

  /// For the mean of several pairs: adds the correlations of the windows of the first `count` places to `planes`, of
  /// plane_size() each.
  int plane_size() const { return (2 * (side_ / 3 + 1) + 1) * (2 * (side_ / 3 + 1) + 1); }
  void add(int count, float* const* planes);
  Peak peak_of(const float* plane, int count) const;

 private:
  struct Plan;
  void transform(int count);
  Peak peak_of(int slot) const;
  int side_, size_;             // of the window, of the transform
  std::vector<float> untaper_;  // 1 / taper's correlation, by lag from -farthest
  std::vector<float> scale_;    // of the windows put in: 1 / (|a| |b|)
  std::unique_ptr<Plan> plan_;
};

}  // namespace pivnp::piv

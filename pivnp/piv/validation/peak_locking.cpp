#include "pivnp/piv/validation/peak_locking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::piv {

namespace {

constexpr int block_side = 32;

float grey(const ImageView& image, int column, int row) {
  switch (image.depth) {
    case PixelDepth::u8:
      return image.row<std::uint8_t>(row)[column];
    case PixelDepth::u16:
      return image.row<std::uint16_t>(row)[column];
    case PixelDepth::f32:
      return image.row<float>(row)[column];
  }
  return 0;
}

// Sums of products at lags of one and two pixels, along rows and columns, of blocks that are usable throughout.
struct Autocovariance {
  double one = 0, two = 0;
  std::int64_t blocks = 0;

  void add(const std::array<float, block_side * block_side>& v) {
    for (int r = 0; r < block_side; ++r)
      for (int c = 0; c + 2 < block_side; ++c) {
        const float along = v[std::size_t(r * block_side + c)], across = v[std::size_t(c * block_side + r)];
        one += double(along * v[std::size_t(r * block_side + c + 1)] + across * v[std::size_t((c + 1) * block_side + r)]);
        two += double(along * v[std::size_t(r * block_side + c + 2)] + across * v[std::size_t((c + 2) * block_side + r)]);
      }
    ++blocks;
  }
};

bool cut(const ImageView& image, const MaskView& mask, int column, int row, std::array<float, block_side * block_side>& v) {
  double sum = 0;
  for (int r = 0; r < block_side; ++r)
    for (int c = 0; c < block_side; ++c) {
      if (!mask.usable(column + c, row + r)) return false;
      sum += double(v[std::size_t(r * block_side + c)] = grey(image, column + c, row + r));
    }
  const float mean = static_cast<float>(sum / (block_side * block_side));
  for (float& value : v) value -= mean;
  return true;
}

}  // namespace

double blob_diameter(const ImageView& image, const MaskView& mask) {
  Autocovariance sums;
  std::array<float, block_side * block_side> v{};
  // A grid of at most 64 x 64 blocks describes any image well enough.
  const int across = std::max(1, image.width / block_side), down = std::max(1, image.height / block_side);
  const int step_x = std::max(1, across / 64), step_y = std::max(1, down / 64);
  for (int j = 0; (j + 1) * block_side <= image.height; j += step_y)
    for (int i = 0; (i + 1) * block_side <= image.width; i += step_x)
      if (cut(image, mask, i * block_side, j * block_side, v)) sums.add(v);
  const double products = 2.0 * block_side * (block_side - 2) * static_cast<double>(std::max<std::int64_t>(sums.blocks, 1));
  const double rounding = 1.0 / 12;  // variance of a grey value's rounding: less is no texture
  if (!(sums.one / products > rounding * (image.depth == PixelDepth::f32 ? 1e-9 : 1.0))) return nan_value;
  // Blobs of variance s^2 (their pixel's 1/12 in it): autocovariance ~ exp(-lag^2 / 4 s^2), less what the blocks' means
  // took off, its integral over a block's area.
  double variance = 0.75 / 0.003, taken = 0;
  for (int round = 0; round < 3; ++round) {
    const double one = sums.one + taken, fall = std::log(one / std::max(sums.two + taken, 0.003 * one));
    if (!(fall > 0.003)) break;  // wider than a block could tell
    variance = 0.75 / fall;
    taken = 4 * std::numbers::pi * variance / (block_side * block_side) * one * std::exp(0.25 / variance);
  }
  return 4 * std::sqrt(std::max(variance - 1.0 / 12, 0.0));
}

namespace {

constexpr int fit_reach = 2, side = 2 * fit_reach + 1;

// The plane through the 24 neighbours (all valid: the same weights everywhere), and their curvature: mean of the outer
// ring less mean of the inner.
struct Plane {
  double mean = 0, slope_i = 0, slope_j = 0, curvature = 0;
  double at(int a, int b) const { return mean + slope_i * a + slope_j * b; }
  /// What a smooth field has in the middle: exact for cubics, so that waves are not taken for locking.
  double middle() const { return mean - 25.0 / 24 * curvature; }
};

// Where a field bends more than this over five nodes, what the fit misses of it looks like a wave of its fractions: shear bands
// would be taken for locking.
constexpr double most_curvature = 0.1;

constexpr double moment = 10 * side;  // of a^2 over the 5 x 5

template <class Value>
Plane fit(const Value& value) {  // of (a, b), the middle left out
  Plane p;
  for (int b = -fit_reach; b <= fit_reach; ++b)
    for (int a = -fit_reach; a <= fit_reach; ++a) {
      if (a == 0 && b == 0) continue;
      const double v = value(a, b);
      const bool outer = std::max(std::abs(a), std::abs(b)) == fit_reach;
      p.mean += v / (side * side - 1), p.slope_i += v * a / moment, p.slope_j += v * b / moment;
      p.curvature += outer ? v / 16 : -v / 8;
    }
  return p;
}

double wave(double d) { return std::sin(2 * std::numbers::pi * d); }

}  // namespace

void FractionStatistics::add(int nx, const std::vector<std::array<float, 2>>& displacement,
                             const std::vector<VectorStatus>& status) {
  const int ny = static_cast<int>(status.size()) / std::max(nx, 1);
  const auto at = [nx](int i, int j) { return std::size_t(j) * std::size_t(nx) + std::size_t(i); };
  for (std::size_t k = 0; k < status.size(); ++k) {
    if (status[k] != VectorStatus::valid) continue;
    for (const float d : displacement[k]) {
      const double fraction = double(d) - std::floor(double(d) + 0.5);
      ++counts_[std::size_t(std::clamp(int((fraction + 0.5) * bins), 0, bins - 1))];
    }
  }
  for (int j = fit_reach; j + fit_reach < ny; ++j)
    for (int i = fit_reach; i + fit_reach < nx; ++i) {
      bool whole = true;
      for (int b = -fit_reach; b <= fit_reach && whole; ++b)
        for (int a = -fit_reach; a <= fit_reach && whole; ++a) whole = status[at(i + a, j + b)] == VectorStatus::valid;
      if (!whole) continue;
      for (std::size_t c = 0; c < 2; ++c) {
        const Plane field = fit([&](int a, int b) { return double(displacement[at(i + a, j + b)][c]); });
        if (std::abs(field.curvature) > most_curvature) continue;
        const Plane drawn = fit([&](int a, int b) { return wave(field.at(a, b)); });
        const double r = double(displacement[at(i, j)][c]) - field.middle(), g = wave(field.mean) - drawn.middle();
        cross_ -= r * g, square_ += g * g, residual_ += r * r;
        ++fits_;
      }
    }
}

std::array<double, FractionStatistics::bins> FractionStatistics::histogram() const {
  std::array<double, bins> shares{};
  double all = 0;
  for (const std::int64_t n : counts_) all += static_cast<double>(n);
  for (std::size_t k = 0; k < bins; ++k) shares[k] = all > 0 ? static_cast<double>(counts_[k]) / all : 0;
  return shares;
}

double FractionStatistics::amplitude_error() const {
  if (fits_ < 25 || !(square_ > 0)) return nan_value;
  // Neighbouring vectors share pixels: about four of them make one independent one.
  const double error = 2 * std::sqrt(residual_ / static_cast<double>(fits_) / square_);
  return error <= 0.02 ? error : nan_value;
}

double FractionStatistics::amplitude() const { return std::isnan(amplitude_error()) ? nan_value : cross_ / square_; }

bool FractionStatistics::locked() const { return amplitude() > std::max(0.02, 4 * amplitude_error()); }

}  // namespace pivnp::piv

#include "pivnp/image/masks/air_mask.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::image {

namespace {

constexpr int half_window = air_window_px / 2;
constexpr double least_ratio = 3;  // between the classes' standard deviations

std::vector<float> shares_of_white(const ImageView& image) {
  std::vector<float> out(std::size_t(image.width) * std::size_t(image.height));
  const auto fill = [&](auto zero) {
    using T = decltype(zero);
    for (int r = 0; r < image.height; ++r) {
      const T* grey = image.row<T>(r);
      for (int c = 0; c < image.width; ++c) out[std::size_t(r) * std::size_t(image.width) + std::size_t(c)] = float(grey[c]) / image.white;
    }
  };
  switch (image.depth) {
    case PixelDepth::u8: fill(std::uint8_t{}); break;
    case PixelDepth::u16: fill(std::uint16_t{}); break;
    case PixelDepth::f32: fill(float{}); break;
  }
  return out;
}

// Mean over the window about each pixel, cut at the image's edge.
void box_mean(std::vector<float>& v, int width, int height) {
  std::vector<double> line;
  const auto pass = [&](int count, int length, std::size_t step, std::size_t along) {
    line.resize(std::size_t(length) + 1);
    for (int k = 0; k < count; ++k) {
      float* at = v.data() + std::size_t(k) * step;
      line[0] = 0;
      for (int n = 0; n < length; ++n) line[std::size_t(n) + 1] = line[std::size_t(n)] + double(at[std::size_t(n) * along]);
      for (int n = 0; n < length; ++n) {
        const int a = std::max(0, n - half_window), b = std::min(length, n + half_window + 1);
        at[std::size_t(n) * along] = float((line[std::size_t(b)] - line[std::size_t(a)]) / (b - a));
      }
    }
  };
  pass(height, width, std::size_t(width), 1);
  pass(width, height, 1, std::size_t(width));
}

// Of the values within the window about each pixel.
std::vector<float> variances(std::vector<float> v, int width, int height) {
  std::vector<float> squares(v.size());
  for (std::size_t k = 0; k < v.size(); ++k) squares[k] = v[k] * v[k];
  box_mean(v, width, height);
  box_mean(squares, width, height);
  for (std::size_t k = 0; k < v.size(); ++k) squares[k] = std::max(squares[k] - v[k] * v[k], 0.F);
  return squares;
}

// What parts two classes of logarithms best; least_ratio apart, or nothing (-infinity).
double parting(const std::vector<float>& variance) {
  constexpr int bins = 200;
  constexpr double lowest = -16, highest = 0;  // of ln variance; 8-bit rounding alone is -13.5
  std::array<double, bins> count{};
  const auto value = [&](int k) { return lowest + (k + 0.5) * (highest - lowest) / bins; };
  for (const float v : variance) ++count[std::size_t(std::clamp(int((std::log(std::max(double(v), 1e-7)) - lowest) / (highest - lowest) * bins), 0, bins - 1))];
  double all = 0, sum = 0;
  for (int k = 0; k < bins; ++k) all += count[std::size_t(k)], sum += count[std::size_t(k)] * value(k);
  double below = 0, below_sum = 0, most = 0, at = -INFINITY;
  for (int k = 0; k + 1 < bins; ++k) {
    below += count[std::size_t(k)], below_sum += count[std::size_t(k)] * value(k);
    if (below == 0 || below == all) continue;
    const double apart = (sum - below_sum) / (all - below) - below_sum / below, between = below * (all - below) * apart * apart;
    if (between > most) most = between, at = apart > 2 * std::log(least_ratio) ? value(k) + (highest - lowest) / bins / 2 : -INFINITY;
  }
  return at;
}

// Groups of connected pixels of `kind` that are smaller than `least` change sides.
void drop_small(std::vector<std::uint8_t>& mark, int width, int height, std::uint8_t kind, std::size_t least) {
  std::vector<std::uint8_t> seen(mark.size());
  std::vector<std::size_t> group;
  for (std::size_t start = 0; start < mark.size(); ++start) {
    if (mark[start] != kind || seen[start]) continue;
    group.assign(1, start);
    seen[start] = 1;
    for (std::size_t n = 0; n < group.size(); ++n) {
      const int c = int(group[n] % std::size_t(width)), r = int(group[n] / std::size_t(width));
      const auto add = [&](int column, int row) {
        if (column < 0 || row < 0 || column >= width || row >= height) return;
        const std::size_t k = std::size_t(row) * std::size_t(width) + std::size_t(column);
        if (mark[k] == kind && !seen[k]) seen[k] = 1, group.push_back(k);
      };
      add(c - 1, r), add(c + 1, r), add(c, r - 1), add(c, r + 1);
    }
    if (group.size() < least)
      for (const std::size_t k : group) mark[k] = std::uint8_t(1 - kind);
  }
}

constexpr std::size_t least_group = 2 * air_window_px * air_window_px;

// Windows that are air as a whole -> pixels that are.
void whole_windows(std::vector<std::uint8_t>& air, int width, int height) {
  drop_small(air, width, height, 1, least_group / 8);
  grow(air, width, height, half_window);
}

}  // namespace

void grow(std::vector<std::uint8_t>& covered, int width, int height, int reach) {
  if (reach == 0) return;
  std::vector<std::uint8_t> wide(covered.size());
  const auto pass = [&](int count, int length, std::size_t step, std::size_t along) {
    for (int line = 0; line < count; ++line)
      for (int k = 0, last = -reach - 1; k < length + reach; ++k) {
        const std::size_t base = std::size_t(line) * step;
        if (k < length && covered[base + std::size_t(k) * along]) last = k;
        if (k >= reach) wide[base + std::size_t(k - reach) * along] = last >= k - 2 * reach;
      }
    covered.swap(wide);
  };
  pass(height, width, std::size_t(width), 1);
  pass(width, height, 1, std::size_t(width));
}

std::vector<std::uint8_t> air_without_texture(const ImageView& image) {
  const std::vector<float> variance = variances(shares_of_white(image), image.width, image.height);
  const double most = std::exp(parting(variance));
  std::vector<std::uint8_t> air(variance.size());
  if (!(most > 0)) return air;
  for (std::size_t k = 0; k < air.size(); ++k) air[k] = double(variance[k]) < most;
  whole_windows(air, image.width, image.height);
  drop_small(air, image.width, image.height, 1, least_group);
  drop_small(air, image.width, image.height, 0, least_group);
  return air;
}

StillBackground::StillBackground(const ImageView& first, const ImageView& second, std::vector<std::uint8_t> material)
    : first_(shares_of_white(first)), material_(std::move(material)) {
  std::vector<float> difference = shares_of_white(second);
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= first_[k];
  difference = variances(std::move(difference), first.width, first.height);
  std::vector<float> outside;
  for (std::size_t k = 0; k < difference.size(); k += 7)
    if (!material_[k]) outside.push_back(difference[k]);
  if (outside.empty()) return;
  std::nth_element(outside.begin(), outside.begin() + std::ptrdiff_t(outside.size() / 2), outside.end());
  constexpr double times = 2.5, rounding = 1.0 / 255 / 255 / 6;  // of two images in eight bits
  most_ = times * times * std::max(double(outside[outside.size() / 2]), rounding);
}

std::vector<std::uint8_t> StillBackground::find(const ImageView& image) const {
  std::vector<float> difference = shares_of_white(image);
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= first_[k];
  difference = variances(std::move(difference), image.width, image.height);
  std::vector<std::uint8_t> air(difference.size());
  for (std::size_t k = 0; k < air.size(); ++k) air[k] = !material_[k] && double(difference[k]) < most_;
  whole_windows(air, image.width, image.height);
  for (std::size_t k = 0; k < air.size(); ++k) air[k] = std::uint8_t(air[k] & (material_[k] == 0));
  drop_small(air, image.width, image.height, 1, least_group);
  drop_small(air, image.width, image.height, 0, least_group);
  return air;
}

}  // namespace pivnp::image

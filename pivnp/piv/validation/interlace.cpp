#include "pivnp/piv/validation/interlace.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pivnp::piv {

namespace {

constexpr std::array delays{-0.5, -0.25, 0.0, 0.25, 0.5};
constexpr int half = 12;           // of the windows, px
constexpr std::size_t least = 20;  // nodes
constexpr double clearly = 1.2;

double grey_at(const ImageView& image, int c, int r) {
  if (image.depth == PixelDepth::u8) return double(image.row<std::uint8_t>(r)[c]);
  if (image.depth == PixelDepth::u16) return double(image.row<std::uint16_t>(r)[c]);
  return double(image.row<float>(r)[c]);
}

// Of the even lines alone, linear between them and along them.
double of_even_lines(const ImageView& image, double x, double y) {
  const int c = int(std::floor(x)), r = 2 * int(std::floor(y / 2));
  const double fx = x - c, fy = (y - r) / 2;
  return (1 - fy) * ((1 - fx) * grey_at(image, c, r) + fx * grey_at(image, c + 1, r)) +
         fy * ((1 - fx) * grey_at(image, c, r + 2) + fx * grey_at(image, c + 1, r + 2));
}

}  // namespace

double field_delay(const ImageView& frame, const MaskView& mask, const NodeLattice& nodes,
                   const std::vector<std::array<float, 2>>& displacement, const std::vector<VectorStatus>& status) {
  std::array<double, delays.size()> sum{};
  std::vector<std::size_t> moving;
  for (std::size_t k = 0; k < status.size(); ++k)
    if (status[k] == VectorStatus::valid && std::hypot(displacement[k][0], displacement[k][1]) >= 1)
      moving.push_back(k);
  if (moving.size() < least) return 0;
  const std::size_t step = std::max<std::size_t>(1, moving.size() / 1000);
  for (std::size_t m = 0; m < moving.size(); m += step) {
    const std::size_t k = moving[m];
    const double u = double(displacement[k][0]), v = double(displacement[k][1]);
    const int column = int(nodes.pixel[k][0]), row = int(nodes.pixel[k][1]);
    const double reach = half + 3 + 0.5 * std::max(std::abs(u), std::abs(v));
    if (column - reach < 0 || row - reach < 0 || column + reach > frame.width - 1 || row + reach > frame.height - 1)
      continue;
    for (int r = (row - half) | 1; r <= row + half; r += 2)
      for (int c = column - half; c <= column + half; ++c) {
        if (!mask.usable(c, r)) continue;
        const double here = grey_at(frame, c, r);
        for (std::size_t d = 0; d < delays.size(); ++d) {
          const double off = here - of_even_lines(frame, c - delays[d] * u, r - delays[d] * v);
          sum[d] += off * off;
        }
      }
  }
  const auto best = std::size_t(std::min_element(sum.begin(), sum.end()) - sum.begin());
  if (std::abs(delays[best]) < 0.5 || !(sum[2] > clearly * sum[best])) return 0;
  return delays[best];
}

}  // namespace pivnp::piv

#include "pivnp/piv/validation/block_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace pivnp::piv {

namespace {

constexpr std::size_t block = 8;

// Steps between neighbours along one direction, by where the first of them lies in its block.
struct Steps {
  std::array<double, block> sum{};
  std::array<double, block> count{};

  void add(std::size_t at, double step) {
    sum[at % block] += step;
    ++count[at % block];
  }
  double mean(std::size_t phase) const { return count[phase] > 0 ? sum[phase] / count[phase] : 0; }
  double mean_but(std::size_t phase) const {
    double steps = 0, n = 0;
    for (std::size_t k = 0; k < block; ++k)
      if (k != phase) steps += sum[k], n += count[k];
    return n > 0 ? steps / n : 0;
  }
};

double ratio(double across, double within) {
  if (within > 0) return across / within;
  return across > 0 ? std::numeric_limits<double>::infinity() : 1;
}

template <class Grey>
void look_at(const ImageView& image, const MaskView& mask, Steps& along_x, Steps& along_y) {
  for (int r = 0; r < image.height; ++r) {
    const Grey* row = image.row<Grey>(r);
    for (int c = 0; c < image.width; ++c) {
      if (!mask.usable(c, r)) continue;
      const double here = double(row[c]);
      if (c + 1 < image.width && mask.usable(c + 1, r)) along_x.add(std::size_t(c), std::abs(double(row[c + 1]) - here));
      if (r + 1 < image.height && mask.usable(c, r + 1)) along_y.add(std::size_t(r), std::abs(double(image.row<Grey>(r + 1)[c]) - here));
    }
  }
}

}  // namespace

double block_edge_ratio(const ImageView& image, const MaskView& mask) {
  Steps along_x, along_y;
  if (image.depth == PixelDepth::u8) look_at<std::uint8_t>(image, mask, along_x, along_y);
  else if (image.depth == PixelDepth::u16) look_at<std::uint16_t>(image, mask, along_x, along_y);
  else look_at<float>(image, mask, along_x, along_y);
  double most = 0;
  for (std::size_t phase = 0; phase < block; ++phase)
    most = std::max(most, 0.5 * (ratio(along_x.mean(phase), along_x.mean_but(phase)) + ratio(along_y.mean(phase), along_y.mean_but(phase))));
  return most;
}

}  // namespace pivnp::piv

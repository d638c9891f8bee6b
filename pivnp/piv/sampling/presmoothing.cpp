#include "pivnp/piv/sampling/presmoothing.hpp"

#include <algorithm>
#include <array>

namespace pivnp::piv {

namespace {

struct Likeness {
  double sum = 0, square = 0, step = 0, count = 0;  // of grey values, and of differences of adjacent ones squared

  template <class Grey>
  void add(const ImageView& image) {
    constexpr int stride = 4;  // rows: a quarter tells as much
    for (int r = 0; r + 1 < image.height; r += stride) {
      const Grey* row = image.row<Grey>(r);
      const Grey* below = image.row<Grey>(r + 1);
      double s = 0, q = 0, d = 0;
      for (int c = 0; c + 1 < image.width; ++c) {
        const float v = static_cast<float>(row[c]), x = static_cast<float>(row[c + 1]) - v,
                    y = static_cast<float>(below[c]) - v;
        s += v, q += v * v, d += 0.5f * (x * x + y * y);
      }
      sum += s, square += q, step += d, count += image.width - 1;
    }
  }
  void operator+=(const Likeness& l) { sum += l.sum, square += l.square, step += l.step, count += l.count; }
  // Correlation of adjacent pixels.
  double value() const {
    if (count == 0) return 1;
    const double variance = square / count - (sum / count) * (sum / count);
    return variance > 0 ? 1 - 0.5 * step / count / variance : 1;
  }
};

}  // namespace

float presmoothing(const ImageView& first, const ImageView& second, int threads) {
  std::array<Likeness, 2> frames;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int k = 0; k < 2; ++k) {
    const ImageView& image = k == 0 ? first : second;
    if (image.depth == PixelDepth::u8)
      frames[std::size_t(k)].add<std::uint8_t>(image);
    else if (image.depth == PixelDepth::u16)
      frames[std::size_t(k)].add<std::uint16_t>(image);
    else
      frames[std::size_t(k)].add<float>(image);
  }
  Likeness likeness = frames[0];
  likeness += frames[1];
  return static_cast<float>(std::clamp(0.17 + 0.5 * (0.66 - likeness.value()), 0.0, 0.25));
}

}  // namespace pivnp::piv

#include "pivnp/piv/sampling/even_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pivnp::piv {

namespace {

constexpr int taps = 6;  // px, three standard deviations

struct Plane {
  int width, height;
  std::vector<float> grey;

  float* row(int r) { return grey.data() + std::ptrdiff_t(r) * width; }
  const float* row(int r) const { return grey.data() + std::ptrdiff_t(r) * width; }
};

template <class Grey>
Plane plane_of(const ImageView& frame) {
  Plane out{frame.width, frame.height, std::vector<float>(std::size_t(frame.width) * std::size_t(frame.height))};
  for (int r = 0; r < frame.height; ++r) std::copy_n(frame.row<Grey>(r), frame.width, out.row(r));
  return out;
}

Plane plane_of(const ImageView& frame) {
  return frame.depth == PixelDepth::u8    ? plane_of<std::uint8_t>(frame)
         : frame.depth == PixelDepth::u16 ? plane_of<std::uint16_t>(frame)
                                          : plane_of<float>(frame);
}

// Mean with Gaussian weights of 2 px; edge pixels stand for what is beyond.
Plane blurred(const Plane& in, int threads) {
  std::array<float, 2 * taps + 1> weight;
  float sum = 0;
  for (int k = -taps; k <= taps; ++k) sum += weight[std::size_t(k + taps)] = std::exp(-float(k * k) / 8);
  for (float& w : weight) w /= sum;
  Plane out = in;
#pragma omp parallel num_threads(threads)
  {
    std::vector<float> down(std::size_t(in.width + 2 * taps));
#pragma omp for schedule(static)
    for (int r = 0; r < in.height; ++r) {
      std::fill(down.begin(), down.end(), 0.0f);
      for (int k = -taps; k <= taps; ++k) {
        const float* from = in.row(std::clamp(r + k, 0, in.height - 1));
        const float w = weight[std::size_t(k + taps)];
        for (int c = 0; c < in.width; ++c) down[std::size_t(c + taps)] += w * from[c];
      }
      std::fill_n(down.begin(), taps, down[std::size_t(taps)]);
      std::fill_n(down.end() - taps, taps, down[std::size_t(taps + in.width - 1)]);
      float* to = out.row(r);
      std::fill_n(to, in.width, 0.0f);
      for (int k = 0; k <= 2 * taps; ++k)
        for (int c = 0; c < in.width; ++c) to[c] += weight[std::size_t(k)] * down[std::size_t(c + k)];
    }
  }
  return out;
}

}  // namespace

Image even_light(const ImageView& frame, int threads) {
  const Plane grey = plane_of(frame), mean = blurred(grey, threads);
  Plane square = grey;
  for (std::size_t k = 0; k < square.grey.size(); ++k) square.grey[k] = (grey.grey[k] - mean.grey[k]) * (grey.grey[k] - mean.grey[k]);
  square = blurred(square, threads);
  Image out(frame.width, frame.height, PixelDepth::f32, frame.white);
  const float white = frame.white, least = 0.01f * white, most = 0.999f * white;
  for (int r = 0; r < frame.height; ++r)
    for (int c = 0; c < frame.width; ++c) {
      const float own = grey.row(r)[c], off = (own - mean.row(r)[c]) / std::max(std::sqrt(square.row(r)[c]), least);
      out.row<float>(r)[c] = own >= white ? white : std::clamp(white / 2 + white / 6 * off, 0.0f, most);
    }
  return out;
}

}  // namespace pivnp::piv

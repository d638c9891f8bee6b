#include "apps/study/methods/frames/noise_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "apps/study/synth/truth.hpp"

namespace pivnp::app {

NoiseShape::NoiseShape(int reach, std::vector<double> weights) : reach_(reach), weights_(std::move(weights)) {
  double squares = 0;
  for (const double w : weights_) squares += w * w;
  for (double& w : weights_) w /= std::sqrt(squares);
}

double NoiseShape::correlation(int columns, int rows) const {
  const int n = 2 * reach_ + 1;
  double sum = 0;
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) {
      const int r2 = r + rows, c2 = c + columns;
      if (r2 < 0 || c2 < 0 || r2 >= n || c2 >= n) continue;
      sum += weights_[std::size_t(r * n + c)] * weights_[std::size_t(r2 * n + c2)];
    }
  return sum;
}

std::vector<float> NoiseShape::draw(int width, int height, std::uint64_t stream) const {
  const int wide = width + 2 * reach_, high = height + 2 * reach_, n = 2 * reach_ + 1;
  std::vector<float> independent(std::size_t(wide) * std::size_t(high));
  for (std::size_t k = 0; k < independent.size(); ++k) {
    const double a = std::max(uniform(stream, 2 * k), 1e-300), b = uniform(stream, 2 * k + 1);
    independent[k] = float(std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b));
  }
  if (white()) return independent;
  std::vector<float> out(std::size_t(width) * std::size_t(height), 0);
  for (int r = 0; r < height; ++r)
    for (int v = 0; v < n; ++v)
      for (int u = 0; u < n; ++u) {
        const float w = float(weights_[std::size_t(v * n + u)]);
        const float* from = independent.data() + std::size_t(r + v) * std::size_t(wide) + std::size_t(u);
        float* to = out.data() + std::size_t(r) * std::size_t(width);
        for (int c = 0; c < width; ++c) to[c] += w * from[c];
      }
  return out;
}

}  // namespace pivnp::app

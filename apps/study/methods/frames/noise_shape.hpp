// Noise of an image whose neighbouring pixels are alike.
#pragma once

#include <cstdint>
#include <vector>

namespace pivnp::app {

/// Noise as a mean of independent values: weights(column, row) up to `reach` pixels around, squares' sum one. Reach 0: the noise of
/// pixels is independent.
class NoiseShape {
 public:
  NoiseShape() : weights_{1} {}
  /// `weights`: (2 reach + 1)^2, row by row. Normalised here.
  NoiseShape(int reach, std::vector<double> weights);

  bool white() const { return reach_ == 0; }
  /// Correlation of the noise of pixels that are (columns, rows) apart.
  double correlation(int columns, int rows) const;
  /// Noise of variance one for an image, row by row; streams are independent of each other.
  std::vector<float> draw(int width, int height, std::uint64_t stream) const;

 private:
  int reach_ = 0;
  std::vector<double> weights_;
};

}  // namespace pivnp::app

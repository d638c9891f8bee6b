// A grey image as coefficients of a quintic B-spline: interpolation at any place, smooth to the fourth derivative.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// Interpolating quintic B-spline of one image: at whole pixels it returns the grey values (to float round-off, about
/// 1e-6 of the range). Beyond the image the coefficients are mirrored about the edge pixels, `padding` deep.
/// Source: Unser, Aldroubi & Eden 1993 (prefilter by recursive filters), Thevenaz, Blu & Unser 2000 (poles).
class SplineImage {
 public:
  static constexpr int padding = 8;

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }
  /// Coefficient of pixel (column, row); both may lie up to `padding` outside.
  const float* coefficient(int column, int row) const {
    return data_.data() + (row + padding) * stride_ + column + padding;
  }

  /// Takes the image, averaged over blocks of `decimation` x `decimation` pixels (what remains at the right and lower
  /// edge is cut), and prefilters it. Masked pixels are left out of the averages. Buffers are reused.
  /// `smoothing` a: along each axis the spline interpolates (a, 1 - 2a, a) times the values instead (0: the values). With it,
  /// blocks of 2 x 2 overlap, weighted (1, 3, 3, 1)/8 along each axis, so that less is aliased.
  void assign(const ImageView& image, const MaskView& mask, int decimation, int threads, float smoothing = 0);

 private:
  void average(const ImageView& image, const MaskView& mask, int decimation, bool overlapping, int threads);
  void prefilter(int threads, float smoothing);
  void mirror_edges();
  float* pixel(int column, int row) { return data_.data() + (row + padding) * stride_ + column + padding; }

  int width_ = 0, height_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<float> data_;
};

}  // namespace pivnp::piv

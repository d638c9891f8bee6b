// A frame's texture as something that can be moved: freed of noise, interpolated, and drawn again with fresh noise.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "apps/study/methods/frames/noise_shape.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::app {

/// Variance of the frames' random part, grey values squared: the median over the usable nodes of (1 - score) times the
/// variance of the first frame in the node's window, since two frames with independent noise n correlate by
/// 1 - n / (signal + n). Of all pairs the one with the best median score counts: motion can only lower it. NaN where no
/// vector is valid.
double noise_variance(const ImageView& first, const std::vector<Vec2>& nodes_px, int window_px,
                      const std::vector<VectorField>& pairs);

class CarriedTexture {
 public:
  /// `noise`: variance of the frame's random part, grey values squared. The frame is freed of it (adaptive Wiener filter over 3 x 3
  /// pixels, Lee 1980) and interpolated by cubic B-splines. `blur`: standard deviation of a Gaussian that takes off before what
  /// interpolation cannot move, px; texture as sharp as its pixels would be found to lag. `shape`: of the noise that is drawn.
  CarriedTexture(const Image& frame, double noise, double blur = 0, NoiseShape shape = {});

  int width() const { return still_.width; }
  int height() const { return still_.height; }
  /// Grey values without noise: of a pixel (column, row), and of any place; beyond its edges the frame is mirrored.
  float still(int c, int r) const { return still_.at(c, r); }
  double at(const Vec2& px) const;
  /// An image of the frame's depth: grey(column, row) of every pixel, and noise of its own by (seed, number).
  Image draw(const std::function<double(int, int)>& grey, std::uint64_t seed, std::uint64_t number) const;

 private:
  struct Grey {  // row by row
    int width = 0, height = 0;
    std::vector<float> value;

    float& at(int c, int r) { return value[std::size_t(r) * std::size_t(width) + std::size_t(c)]; }
    float at(int c, int r) const { return value[std::size_t(r) * std::size_t(width) + std::size_t(c)]; }
  };
  friend double noise_variance(const ImageView&, const std::vector<Vec2>&, int, const std::vector<VectorField>&);
  struct Moments;
  static Grey grey_of(const ImageView& image);
  static Moments moments(const Grey& g, int c0, int c1, int r0, int r1);
  static Grey without_noise(const Grey& g, double noise);
  static Grey blurred(const Grey& g, double sigma);
  static Grey coefficients(const Grey& g);

  Grey still_, spline_;
  double noise_;  // standard deviation
  NoiseShape shape_;
  PixelDepth depth_;
  float white_;
};

}  // namespace pivnp::app

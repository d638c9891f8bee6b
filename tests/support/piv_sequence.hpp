// Sequences of frames with known motion: texture that a map carries, seen under light, noise, loss and compression.
// The map is analytic: nothing here uses the correlation or the particles under test.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/image/synthetic/synthetic.hpp"

namespace pivnp::piv {

/// Everything in pixels (column, row), row downward.
struct Sequence {
  int width = 512, height = 512, frames = 2, seed = 1;
  std::function<Vec2(const Vec2&, int)> place = {};  // where material that is at X in frame 0 is in frame k
  image::TextureOptions texture = image::soil_texture();
  std::function<bool(const Vec2&)> material = {};  // of places in frame 0; empty: everywhere
  double behind = 0;  // contrast of the ground that stands still behind it, share of its own
  std::function<double(double, double, int)> light = {};  // factor on the grey values; empty: 1
  std::function<double(double, double, int)> cover = {};  // share that a plain body hides; empty: nothing
  std::function<double(double, double)> cover_grey = {};  // of that body, share of white
  std::function<double(double, double)> pattern = {};     // added by the glass, share of white; stands still
  double blur_px = 0;                                     // of the frame where `blurred`
  std::function<bool(double, double)> blurred = {};
  double noise = 0;  // at mid grey, share of white; its variance half even and half with the signal
  int jpeg = 0;      // quality; 0: not compressed
};

namespace sequence {

inline double random01(std::uint64_t seed, std::uint64_t stream, std::uint64_t k) {
  std::uint64_t z = (seed * 0x9e3779b97f4a7c15ull + stream) * 0xbf58476d1ce4e5b9ull + k * 0x9e3779b97f4a7c15ull;
  for (int round = 0; round < 2; ++round) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1.0p-53;
}

inline double normal(std::uint64_t seed, std::uint64_t stream, std::uint64_t k) {  // Box & Muller 1958
  const double r = std::sqrt(-2 * std::log(1 - random01(seed, stream, 2 * k)));
  return r * std::cos(2 * M_PI * random01(seed, stream, 2 * k + 1));
}

inline constexpr double margin = 64;  // texture beyond the frame, which moves in

inline std::vector<double> grey_of(const image::TextureOptions& options, const std::vector<Vec2>& blobs, int width,
                                   int height) {
  image::TextureOptions deep = options;
  deep.bits = 16, deep.noise = 0, deep.light_slope = deep.light_change = 0;
  Image drawn = image::BlobRenderer(deep, width, height).draw(blobs, 0, 2);
  std::vector<double> grey;
  for (int r = 0; r < height; ++r) {
    const std::uint16_t* row = drawn.row<std::uint16_t>(r);
    for (int c = 0; c < width; ++c) grey.push_back(row[c] / 65535.0);
  }
  return grey;
}

/// Where the material that is at x in frame k was in frame 0, by Newton's method with the secant of differences.
inline Vec2 origin(const Sequence& s, const Vec2& x, int k) {
  Vec2 from = x;
  for (int n = 0; n < 30; ++n) {
    const Vec2 off = x - s.place(from, k);
    if (off.squaredNorm() < 1e-16) break;
    Mat2 f;
    f.col(0) = 50 * (s.place(from + Vec2(.01, 0), k) - s.place(from - Vec2(.01, 0), k));
    f.col(1) = 50 * (s.place(from + Vec2(0, .01), k) - s.place(from - Vec2(0, .01), k));
    Vec2 step = f.inverse() * off;
    if (step.norm() > 20) step *= 20 / step.norm();
    from += step;
  }
  return from;
}

}  // namespace sequence

/// Deformation gradient of the material at X in frame 0, in frame k.
inline Mat2 gradient_of(const Sequence& s, const Vec2& X, int k) {
  constexpr double h = 1e-3;
  Mat2 f;
  f.col(0) = (s.place(X + Vec2(h, 0), k) - s.place(X - Vec2(h, 0), k)) / (2 * h);
  f.col(1) = (s.place(X + Vec2(0, h), k) - s.place(X - Vec2(0, h), k)) / (2 * h);
  return f;
}

/// Frame k, 8 bit. texture.loss of the blobs are others in every frame.
inline Image draw(const Sequence& s, int k) {
  using namespace sequence;
  const auto seed = static_cast<std::uint64_t>(s.seed);
  const double across = s.width + 2 * margin, down = s.height + 2 * margin;
  const auto count = static_cast<std::size_t>(s.texture.density_per_px * across * down);
  const auto scattered = [&](std::uint64_t stream, std::uint64_t n) {
    return Vec2(random01(seed, stream, 2 * n) * across - margin, random01(seed, stream, 2 * n + 1) * down - margin);
  };
  image::TextureOptions texture = s.texture;
  texture.seed = s.seed;
  std::vector<Vec2> blobs(count);
  const auto frame = static_cast<std::uint64_t>(k);
  for (std::size_t n = 0; n < count; ++n)
    blobs[n] = random01(seed, 100 + frame, n) < texture.loss ? scattered(1000 + frame, n) : s.place(scattered(1, n), k);
  std::vector<double> grey = grey_of(texture, blobs, s.width, s.height);
  if (s.blurred) {
    texture.blur_px = s.blur_px;
    const std::vector<double> soft = grey_of(texture, blobs, s.width, s.height);
    for (int r = 0; r < s.height; ++r)
      for (int c = 0; c < s.width; ++c)
        if (s.blurred(c, r)) grey[std::size_t(r * s.width + c)] = soft[std::size_t(r * s.width + c)];
  }
  if (s.material) {
    image::TextureOptions ground = s.texture;
    ground.seed = s.seed + 7, ground.peak_min *= s.behind, ground.peak_max *= s.behind;
    for (std::size_t n = 0; n < count; ++n) blobs[n] = scattered(2, n);
    const std::vector<double> still = grey_of(ground, blobs, s.width, s.height);
    for (int r = 0; r < s.height; ++r)
      for (int c = 0; c < s.width; ++c)
        if (!s.material(origin(s, Vec2(c, r), k))) grey[std::size_t(r * s.width + c)] = still[std::size_t(r * s.width + c)];
  }
  Image image(s.width, s.height, PixelDepth::u8, 255.0f);
  for (int r = 0; r < s.height; ++r)
    for (int c = 0; c < s.width; ++c) {
      const std::size_t p = std::size_t(r) * std::size_t(s.width) + std::size_t(c);
      double g = grey[p];
      if (s.cover) {
        const double hidden = s.cover(c, r, k);
        g = (1 - hidden) * g + hidden * s.cover_grey(c, r);
      }
      if (s.light) g *= s.light(c, r, k);
      if (s.pattern) g += s.pattern(c, r);
      if (s.noise > 0) g += s.noise * std::sqrt(0.5 + std::max(g, 0.0)) * normal(seed, 5000 + frame, p);
      image.row<std::uint8_t>(r)[c] = static_cast<std::uint8_t>(std::lround(std::clamp(255 * g, 0.0, 255.0)));
    }
  if (s.jpeg > 0) {
    const cv::Mat whole(s.height, s.width, CV_8U, image.row<std::uint8_t>(0));
    std::vector<std::uint8_t> bytes;
    cv::imencode(".jpg", whole, bytes, {cv::IMWRITE_JPEG_QUALITY, s.jpeg});
    cv::imdecode(bytes, cv::IMREAD_GRAYSCALE).copyTo(whole);
  }
  return image;
}

namespace sequence {

/// Shear band along a line tilted by 5 degrees through the frame's middle: the sides move by -step and step px a frame
/// (tanh(s / half_width)).
inline auto band(const Sequence& s, double step, double half_width) {
  const double c = std::cos(5 * M_PI / 180), t = std::sin(5 * M_PI / 180), x = 0.5 * s.width, y = 0.5 * s.height;
  return [=](const Vec2& X, int k) -> Vec2 {
    const double across = -t * (X.x() - x) + c * (X.y() - y);
    return X + k * step * std::tanh(across / half_width) * Vec2(c, t);
  };
}

/// Turns about the middle, fastest (px a frame) at `radius`; exact circles.
inline auto vortex(const Sequence& s, double step, double radius) {
  const Vec2 middle(0.5 * s.width, 0.5 * s.height);
  return [=](const Vec2& X, int k) -> Vec2 {
    const Vec2 r = X - middle;
    const double turn = k * step / radius * std::exp(0.5 * (1 - r.squaredNorm() / (radius * radius)));
    const double c = std::cos(turn), n = std::sin(turn);
    return middle + Vec2(c * r.x() - n * r.y(), n * r.x() + c * r.y());
  };
}

/// Extension along x by `rate` a frame, compression along y by the same, about the middle.
inline auto extension(const Sequence& s, double rate) {
  const Vec2 middle(0.5 * s.width, 0.5 * s.height);
  return [=](const Vec2& X, int k) -> Vec2 {
    const Vec2 r = X - middle;
    return middle + Vec2(std::exp(rate * k) * r.x(), std::exp(-rate * k) * r.y());
  };
}

inline auto uniform(double u, double v) {
  return [=](const Vec2& X, int k) -> Vec2 { return X + k * Vec2(u, v); };
}

}  // namespace sequence

}  // namespace pivnp::piv

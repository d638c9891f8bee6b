// Synthetic frames: a blob is where it was put and as bright as asked, noise has the stated spread, seeds repeat.
#include "pivnp/image/synthetic/synthetic.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "pivnp/core/error.hpp"

namespace pivnp::image {
namespace {

double grey(const Image& image, int column, int row) {
  const ImageView view = image.view();
  return view.depth == PixelDepth::u8 ? view.row<std::uint8_t>(row)[column] : view.row<std::uint16_t>(row)[column];
}

std::vector<Vec2> scattered(int width, int height, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vec2> centres(count);
  for (Vec2& c : centres) c = {(random() % 100000) * 1e-5 * width, (random() % 100000) * 1e-5 * height};
  return centres;
}

std::size_t differing(const Image& a, const Image& b) {
  std::size_t count = 0;
  for (int r = 0; r < a.height(); ++r)
    for (int c = 0; c < a.width(); ++c) count += grey(a, c, r) != grey(b, c, r);
  return count;
}

struct Moments {
  double sum = 0, column = 0, row = 0, column_variance = 0;
};

Moments moments(const Image& image, double background) {
  Moments m;
  for (int r = 0; r < image.height(); ++r)
    for (int c = 0; c < image.width(); ++c) {
      const double g = grey(image, c, r) - background;
      m.sum += g, m.column += g * c, m.row += g * r, m.column_variance += g * c * c;
    }
  m.column /= m.sum, m.row /= m.sum;
  m.column_variance = m.column_variance / m.sum - m.column * m.column;
  return m;
}

TEST(Synthetic, ABlobHasItsPlaceWidthAndPeak) {
  TextureOptions options{.blob_diameter_px = 4.0, .peak_min = 0.5, .peak_max = 0.5, .background = 0, .bits = 16};
  const BlobRenderer renderer(options, 41, 31);
  const Image centred = renderer.draw(std::vector<Vec2>{{20, 15}}, 0, 1);
  EXPECT_NEAR(grey(centred, 20, 15), 0.5 * 65535, 1.0);
  EXPECT_EQ(grey(centred, 19, 15), grey(centred, 21, 15));
  EXPECT_EQ(grey(centred, 20, 14), grey(centred, 19, 15));
  const Image moved = renderer.draw(std::vector<Vec2>{{20.3, 14.6}}, 0, 1);
  const Moments m = moments(moved, 0);
  EXPECT_NEAR(m.column, 20.3, 1e-3);
  EXPECT_NEAR(m.row, 14.6, 1e-3);
  EXPECT_NEAR(m.column_variance, 1.0 + 1.0 / 12, 5e-3);  // Gaussian of sigma 1 integrated over pixels
  EXPECT_NEAR(m.sum, moments(centred, 0).sum, 30.0);     // light is neither lost nor made by moving
}

// A grain that its material has sheared is the sheared grain: its moments are F C F^T, its light grows with its area.
TEST(Synthetic, AGrainTakesTheDeformationGradient) {
  TextureOptions options{.blob_diameter_px = 8.0, .peak_min = 0.3, .peak_max = 0.3, .background = 0, .bits = 16};
  const BlobRenderer renderer(options, 81, 61);
  const std::vector<Vec2> at{{40.3, 29.6}};
  Mat2 F;
  F << 1.2, 0.9, 0.0, 0.9;
  const Moments round = moments(renderer.draw(at, 0, 1), 0), same = moments(renderer.draw(at, 0, 1, std::vector<Mat2>{Mat2::Identity()}), 0);
  EXPECT_NEAR(same.sum, round.sum, 2e-3 * round.sum);
  EXPECT_NEAR(same.column_variance, round.column_variance, 0.01);
  const Moments m = moments(renderer.draw(at, 0, 1, std::vector<Mat2>{F}), 0);
  EXPECT_NEAR(m.column, 40.3, 2e-2);
  EXPECT_NEAR(m.row, 29.6, 2e-2);
  EXPECT_NEAR(m.sum, round.sum * F.determinant(), 5e-3 * round.sum);
  const double own = 4;  // px^2; and a twelfth for the pixel
  EXPECT_NEAR(m.column_variance, own * (1.2 * 1.2 + 0.9 * 0.9) + 1.0 / 12, 0.06);
}

TEST(Synthetic, GreyValuesAreTheGaussianIntegral) {
  TextureOptions options{.blob_diameter_px = 3.0, .peak_min = 0.4, .peak_max = 0.4, .background = 0.1, .bits = 16};
  const Image image = BlobRenderer(options, 21, 21).draw(std::vector<Vec2>{{9.7, 11.2}}, 0, 1);
  const double sigma = 0.75, per_axis = std::erf(0.5 / sigma / std::sqrt(2.0));
  const auto share = [&](double pixel, double centre) {
    const double s = sigma * std::sqrt(2.0);
    return (std::erf((pixel + 0.5 - centre) / s) - std::erf((pixel - 0.5 - centre) / s)) / 2;
  };
  for (int r = 0; r < 21; ++r)
    for (int c = 0; c < 21; ++c)
      EXPECT_NEAR(grey(image, c, r), 65535 * (0.1 + 0.4 / (per_axis * per_axis) * share(c, 9.7) * share(r, 11.2)), 0.6);
}

TEST(Synthetic, OverlapAddsAndClipsAtWhite) {
  TextureOptions options{.peak_min = 0.4, .peak_max = 0.4, .background = 0.1, .bits = 12};
  const BlobRenderer renderer(options, 15, 15);
  EXPECT_NEAR(grey(renderer.draw(std::vector<Vec2>{{7, 7}, {7, 7}}, 0, 1), 7, 7), 0.9 * 4095, 1.0);
  const Image three = renderer.draw(std::vector<Vec2>{{7, 7}, {7, 7}, {7, 7}}, 0, 1);
  EXPECT_EQ(grey(three, 7, 7), 4095);
  EXPECT_EQ(three.white(), 4095);
  EXPECT_EQ(three.depth(), PixelDepth::u16);
}

TEST(Synthetic, NoiseHasTheStatedSpreadAndIsIndependentBetweenFrames) {
  TextureOptions options{.background = 0.5, .noise = 0.05};
  const BlobRenderer renderer(options, 400, 300);
  const Image a = renderer.draw({}, 0, 2), b = renderer.draw({}, 1, 2);
  double mean = 0, aa = 0, ab = 0, neighbour = 0;
  const double n = 400.0 * 300.0;
  for (int r = 0; r < 300; ++r)
    for (int c = 0; c < 400; ++c) mean += grey(a, c, r) / n;
  for (int r = 0; r < 300; ++r)
    for (int c = 0; c < 400; ++c) {
      const double da = grey(a, c, r) - 127.5;
      aa += da * da / n, ab += da * (grey(b, c, r) - 127.5) / n;
      if (c > 0) neighbour += da * (grey(a, c - 1, r) - 127.5) / n;
    }
  EXPECT_NEAR(mean, 127.5, 0.2);
  EXPECT_NEAR(std::sqrt(aa), 0.05 * 255, 0.1);
  EXPECT_LT(std::abs(ab) / aa, 0.015);
  EXPECT_LT(std::abs(neighbour) / aa, 0.015);
}

TEST(Synthetic, SameSeedSameBitsOtherSeedOtherPeaksAndNoise) {
  const auto centres = scattered(64, 48, 150, 3);
  TextureOptions options{.noise = 0.02, .seed = 5};
  const Image once = BlobRenderer(options, 64, 48).draw(centres, 2, 4);
  EXPECT_EQ(differing(once, BlobRenderer(options, 64, 48).draw(centres, 2, 4)), 0u);
  options.seed = 6;
  EXPECT_GT(differing(once, BlobRenderer(options, 64, 48).draw(centres, 2, 4)), 64u * 48u / 2u);
}

// A figure from one machine that every other must repeat.
TEST(Synthetic, BitsAreTheSameOnEveryPlatform) {
  const auto centres = scattered(64, 48, 150, 3);
  TextureOptions options{.noise = 0.02, .light_slope = 0.3, .light_change = 0.1, .bits = 16, .seed = 5};
  const Image image = BlobRenderer(options, 64, 48).draw(centres, 1, 4);
  std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
  for (int r = 0; r < 48; ++r)
    for (int c = 0; c < 64; ++c) hash = (hash ^ static_cast<std::uint64_t>(grey(image, c, r))) * 1099511628211ull;
  EXPECT_EQ(hash, 11622207698841190850ull);
}

TEST(Synthetic, LightFallsAcrossTheImageAndSwingsInTime) {
  TextureOptions options{.background = 0.8, .light_slope = 0.4, .light_change = 0.1, .bits = 16};
  const BlobRenderer renderer(options, 101, 5);
  const Image first = renderer.draw({}, 0, 2), second = renderer.draw({}, 1, 2);
  EXPECT_NEAR(grey(first, 100, 2) / grey(first, 0, 2), 0.6, 1e-4);
  EXPECT_NEAR(grey(first, 50, 2) / grey(first, 0, 2), 0.8, 1e-4);
  EXPECT_NEAR(grey(first, 50, 2) / grey(second, 50, 2), 1.05 / 0.95, 1e-3);
}

TEST(Synthetic, LostBlobsAreTheStatedShareAndDifferBetweenFrames) {
  TextureOptions options{.loss = 0.2};
  const BlobRenderer renderer(options, 64, 64);
  const auto one = renderer.lost(100000, 1), two = renderer.lost(100000, 2);
  EXPECT_NEAR(static_cast<double>(one.size()), 20000, 500);
  std::vector<std::size_t> both;
  std::set_intersection(one.begin(), one.end(), two.begin(), two.end(), std::back_inserter(both));
  EXPECT_NEAR(static_cast<double>(both.size()), 4000, 300);
  options.loss = 0;
  EXPECT_TRUE(BlobRenderer(options, 64, 64).lost(1000, 1).empty());
}

TEST(Synthetic, BlobsAtAndBeyondTheEdgeAreCut) {
  TextureOptions options{.peak_min = 0.5, .peak_max = 0.5, .background = 0, .bits = 16};
  const BlobRenderer renderer(options, 9, 7);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Image image = renderer.draw(std::vector<Vec2>{{-0.5, 3}, {-50, 3}, {4, 1e9}, {nan, 2}, {-1e30, -1e30}}, 0, 1);
  EXPECT_GT(grey(image, 0, 3), 0);
  EXPECT_EQ(grey(image, 8, 3), 0);
}

TEST(Synthetic, UnknownDepthAndSizeAreRefused) {
  TextureOptions options;
  options.bits = 10;
  EXPECT_THROW(BlobRenderer(options, 10, 10), InputError);
  options.bits = 8;
  EXPECT_THROW(BlobRenderer(options, 0, 10), InputError);
}

}  // namespace
}  // namespace pivnp::image

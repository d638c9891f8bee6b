// Pairs of synthetic frames: the truth of both anchors by its own definition, and where the light of a blob ends up.
#include "pivnp/image/synthetic/synthetic_pair.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "pivnp/core/error.hpp"

namespace pivnp::image {
namespace {

TEST(SyntheticPair, CentralTruthIsThatOfTheParticleWhoseMidPointIsThere) {
  for (const Motion& motion :
       {uniform(3.2, -1), rotation(5, 50, 40), plain_shear(0.3, 30), triangle_shear(0.2), sine(2, 40),
        band(4, 8, 50, 50), vortex(5, 30, 40, 60), strain_concentration(0.02, 0.2, 12, 50, 50)})
    for (const Vec2& start : {Vec2(20.3, 81.1), Vec2(47, 44.5), Vec2(90, 12)}) {
      const Vec2 d = motion(start), middle = start + 0.5 * d;
      EXPECT_NEAR((displacement_at(motion, middle, Anchor::central) - d).norm(), 0, 1e-9);
      EXPECT_EQ(displacement_at(motion, start, Anchor::forward), d);
    }
}

Mat2 gradient(const Motion& motion, const Vec2& p) {
  Mat2 g;
  constexpr double h = 1e-4;
  g.col(0) = (motion(p + Vec2(h, 0)) - motion(p - Vec2(h, 0))) / (2 * h);
  g.col(1) = (motion(p + Vec2(0, h)) - motion(p - Vec2(0, h))) / (2 * h);
  return g;
}

TEST(SyntheticPair, MotionsHaveTheGradientsTheyAreNamedFor) {
  EXPECT_NEAR(gradient(triangle_shear(0.2), {10, 64})(0, 1), 0.2, 1e-6);
  EXPECT_NEAR(gradient(triangle_shear(0.2), {10, 192})(0, 1), -0.2, 1e-6);
  const double a = rotation(90, 50, 50)(Vec2(60, 50)).y();
  EXPECT_NEAR(a, 10, 1e-12);
  const Motion concentrated = strain_concentration(0.02, 0.1, 16, 50, 50);
  EXPECT_NEAR(gradient(concentrated, {50, 50})(0, 0), 0.12, 1e-6);
  EXPECT_NEAR(gradient(concentrated, {50, 200})(0, 0), 0.02, 1e-6);
  EXPECT_NEAR(gradient(vortex(4, 30, 50, 50), {63, 41}).trace(), 0, 1e-6);  // no change of area
  EXPECT_NEAR(vortex(4, 30, 50, 50)(Vec2(80, 50)).norm(), 4, 1e-12);
  EXPECT_NEAR((gradient(band(4, 8, 50, 50), {50, 50})).norm(), 0.5, 1e-6);
}

// One blob, drawn alone: its centre of light moves by the motion, sub-pixel, to the rounding of 16 bits.
TEST(SyntheticPair, BlobsAreDrawnWhereTheMotionTakesThem) {
  TextureOptions texture;
  texture.bits = 16, texture.background = 0, texture.density_per_px = 1.01 / (137.0 * 137.0);
  int seen = 0;
  for (int seed = 1; seed < 60; ++seed) {
    texture.seed = seed;
    const SyntheticPair pair = synthetic_pair(uniform(1.37, -2.21), 41, 41, texture);
    Vec2 centre[2] = {Vec2::Zero(), Vec2::Zero()};
    double light[2] = {0, 0}, rim = 0;
    for (int frame = 0; frame < 2; ++frame)
      for (int r = 0; r < 41; ++r)
        for (int c = 0; c < 41; ++c) {
          const double grey = (frame ? pair.second : pair.first).view().row<std::uint16_t>(r)[c];
          light[frame] += grey, centre[frame] += grey * Vec2(c, r);
          if (r == 0 || c == 0 || r == 40 || c == 40) rim += grey;
        }
    if (light[0] == 0 || light[1] == 0 || rim > 0) continue;
    ++seen;
    const Vec2 moved = centre[1] / light[1] - centre[0] / light[0];
    EXPECT_NEAR(moved.x(), 1.37, 1e-3) << seed;
    EXPECT_NEAR(moved.y(), -2.21, 1e-3) << seed;
  }
  EXPECT_GE(seen, 2);
}

double mean_grey(const Image& image) {
  double sum = 0;
  for (int r = 0; r < image.height(); ++r)
    for (int c = 0; c < image.width(); ++c) sum += image.view().row<std::uint16_t>(r)[c];
  return sum / (image.width() * image.height()) / 65535;
}

double contrast(const Image& image) {
  const double mean = mean_grey(image);
  double square = 0;
  for (int r = 0; r < image.height(); ++r)
    for (int c = 0; c < image.width(); ++c) {
      const double d = image.view().row<std::uint16_t>(r)[c] / 65535.0 - mean;
      square += d * d;
    }
  return std::sqrt(square / (image.width() * image.height()));
}

TEST(SyntheticPair, BlurKeepsTheLightAndLowersTheContrast) {
  TextureOptions texture;
  texture.bits = 16, texture.density_per_px = 0.01, texture.peak_max = 0.4;
  const Image sharp = synthetic_pair(uniform(0, 0), 128, 128, texture).first;
  texture.blur_px = 1.5;
  const Image blurred = synthetic_pair(uniform(0, 0), 128, 128, texture).first;
  EXPECT_NEAR(mean_grey(blurred), mean_grey(sharp), 0.01 * mean_grey(sharp));
  EXPECT_LT(contrast(blurred), 0.6 * contrast(sharp));
}

TEST(SyntheticPair, SoilIsDenseAboutAMidGreyAndHardlyClips) {
  TextureOptions texture = soil_texture();
  texture.bits = 16;
  const Image image = synthetic_pair(uniform(0, 0), 256, 256, texture).first;
  EXPECT_NEAR(mean_grey(image), 0.45, 0.03);
  EXPECT_GT(contrast(image), 0.08);
  int clipped = 0, even = 0;
  for (int r = 0; r < 256; ++r)
    for (int c = 0; c < 256; ++c) {
      const auto grey = image.view().row<std::uint16_t>(r)[c];
      clipped += grey == 0 || grey == 65535;
      even += std::abs(grey / 65535.0 - 0.45) < 1e-3;
    }
  EXPECT_LT(clipped, 256 * 256 / 100);
  EXPECT_LT(even, 256 * 256 / 20);  // texture everywhere
}

}  // namespace
}  // namespace pivnp::image

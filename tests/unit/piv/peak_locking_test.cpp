// Peak locking: diameters of blobs known by drawing, and drawn-in fields of known strength.
#include "pivnp/piv/validation/peak_locking.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/piv/scene.hpp"

namespace pivnp::piv {
namespace {

double drawn_diameter(double diameter, double noise, int bits = 8, double light_slope = 0) {
  image::TextureOptions texture;
  texture.blob_diameter_px = diameter, texture.noise = noise, texture.bits = bits, texture.light_slope = light_slope;
  texture.density_per_px = std::min(0.05, 0.2 / (diameter * diameter));  // hardly any overlap that would clip
  const Scene scene = make_scene(uniform(0, 0), 640, 640, texture);
  return blob_diameter(scene.first.view(), {});
}

TEST(BlobDiameter, IsThatOfTheDrawing) {
  for (const double diameter : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0})
    for (const double noise : {0.0, 0.05}) {
      const double found = drawn_diameter(diameter, noise);
      EXPECT_NEAR(found, diameter, 0.1 * diameter + 0.1) << noise;
      EXPECT_EQ(found < least_blob_px, diameter < least_blob_px) << diameter << ' ' << noise;
    }
  EXPECT_NEAR(drawn_diameter(3, 0, 16), 3, 0.3);
  EXPECT_NEAR(drawn_diameter(3, 0, 8, 0.4), 3, 0.3);
}

TEST(BlobDiameter, IsUnknownWithoutTexture) {
  Image even(64, 64, PixelDepth::u8, 255);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) even.row<std::uint8_t>(r)[c] = 90;
  EXPECT_TRUE(std::isnan(blob_diameter(even.view(), {})));
  const Scene scene = make_scene(uniform(0, 0), 64, 64, {});
  const std::vector<std::uint8_t> none(64 * 64, 0);
  EXPECT_TRUE(std::isnan(blob_diameter(scene.first.view(), {none.data(), 64, 64, 64})));
  EXPECT_TRUE(std::isnan(blob_diameter(Image(20, 20, PixelDepth::u8, 255).view(), {})));  // no block fits
}

FractionStatistics statistics(const Motion& motion, double locking, double noise, unsigned seed) {
  constexpr int nx = 60, ny = 50;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::array<float, 2>> displacement;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 d = motion(Vec2(8 * i, 8 * j));
      std::array<float, 2> found;
      for (int c = 0; c < 2; ++c)
        found[std::size_t(c)] = static_cast<float>(d[c] - locking * std::sin(2 * M_PI * d[c]) + noise * normal(random));
      displacement.push_back(found);
    }
  FractionStatistics s;
  s.add(nx, displacement, std::vector<VectorStatus>(displacement.size(), VectorStatus::valid));
  return s;
}

TEST(Fractions, AmplitudeOfTheLockingIsFound) {
  for (const Motion& motion : {rotation(2, 240, 200), rotation(3, 240, 200), plain_shear(0.05, 200),
                               image::vortex(4, 100, 240, 200), band(4, 40, 240, 200)})
    for (const double locking : {0.05, 0.1}) {
      const FractionStatistics s = statistics(motion, locking, 0.02, 3);
      EXPECT_NEAR(s.amplitude(), locking, 0.3 * locking + 3 * s.amplitude_error());
      EXPECT_TRUE(s.locked()) << s.amplitude() << ' ' << s.amplitude_error();
    }
}

TEST(Fractions, FieldsWithoutLockingAreNotAccused) {
  for (const Motion& motion :
       {uniform(0, 0), uniform(2.3, -1.4), rotation(1, 240, 200), plain_shear(0.1, 200), sine(1, 128), sine(1, 64),
        band(4, 16, 240, 200), band(2, 8, 240, 200), band(4, 10, 240, 200), band(1.3, 10, 243, 195), band(.7, 10, 240, 200), image::vortex(4, 60, 240, 200), image::strain_concentration(0.02, 0.1, 32, 240, 200)})
    for (const double noise : {0.003, 0.03})
      for (const unsigned seed : {1u, 2u, 3u}) {
        const FractionStatistics s = statistics(motion, 0, noise, seed);
        EXPECT_FALSE(s.locked()) << motion(Vec2(37, 81)).transpose() << ' ' << s.amplitude() << ' '
                                 << s.amplitude_error();
      }
  EXPECT_TRUE(std::isnan(statistics(uniform(1.3, 2), 0.1, 0.02, 1).amplitude()));  // an even field cannot tell
}

TEST(Fractions, HistogramHoldsEveryComponent) {
  const auto even = statistics(plain_shear(0.0825, 200), 0, 0, 1).histogram();
  double sum = 0;
  for (const double share : even) sum += share;
  EXPECT_NEAR(sum, 1, 1e-12);
  const auto drawn = statistics(rotation(3, 240, 200), 0.15, 0, 1).histogram();
  EXPECT_GT(drawn[10] + drawn[9], 2 * (drawn[0] + drawn[19]));  // more at whole pixels than half-way between
}

}  // namespace
}  // namespace pivnp::piv

// Particles and frames as pixels.
#include "apps/plot/raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace pivnp::plot {
namespace {

std::size_t covered(const Raster& r) {
  std::size_t n = 0;
  for (std::uint32_t p : r.pixels) n += p >> 24 == 255;
  return n;
}

std::uint32_t at(const Raster& r, int column, int row) {
  return r.pixels[std::size_t(row) * std::size_t(r.width) + std::size_t(column)];
}

// Sheared squares of a lattice fill the plane, whatever the shear.
TEST(Raster, TilesLeaveNoGap) {
  const double shear = 0.7;
  std::vector<Tile> tiles;
  for (int j = -40; j < 60; ++j)
    for (int i = -40; i < 60; ++i)
      tiles.push_back(
          {Vec2(0.05 * i + shear * 0.05 * j, 0.05 * j), Vec2(0.026, 0), Vec2(0.026 * shear, 0.026), 0x123456});
  const Raster r = draw_tiles(tiles, {Vec2(0, 0), Vec2(1, 1)}, 333);
  EXPECT_EQ(covered(r), r.pixels.size());
  EXPECT_EQ(at(r, 100, 100), 0xff123456u);
}

// The area painted is the tiles', y points up, the last drawn lies on top, and a speck is not lost.
TEST(Raster, TilesAreWhereTheyBelong) {
  const Box box{Vec2(0, 0), Vec2(2, 1)};
  const std::vector<Tile> tiles = {{Vec2(0.5, 0.75), Vec2(0.25, 0), Vec2(0, 0.25), 0xff0000},
                                   {Vec2(0.5, 0.75), Vec2(0.1, 0), Vec2(0, 0.1), 0x00ff00},
                                   {Vec2(1.5, 0.25), Vec2(1e-9, 0), Vec2(0, 1e-9), 0x0000ff},
                                   {Vec2(NAN, 0.25), Vec2(1, 0), Vec2(0, 1), 0x000000}};
  const Raster r = draw_tiles(tiles, box, 200);
  EXPECT_EQ(r.height, 100);
  EXPECT_EQ(at(r, 50, 25), 0xff00ff00u);
  EXPECT_EQ(at(r, 30, 10), 0xffff0000u);
  EXPECT_EQ(at(r, 50, 75) >> 24, 0u);
  EXPECT_NEAR(double(covered(r)), 50 * 50, 60);
  EXPECT_GT(at(r, 150, 75) >> 24 | at(r, 149, 75) >> 24 | at(r, 150, 74) >> 24 | at(r, 149, 74) >> 24, 0u);
}

TEST(Raster, ColourMapsAreOrdered) {
  auto luminance = [](Rgb c) { return 0.2126 * (c >> 16 & 255) + 0.7152 * (c >> 8 & 255) + 0.0722 * (c & 255); };
  for (int k = 1; k <= 64; ++k)
    EXPECT_GT(luminance(colour_at(Colours::sequential, k / 64.0)),
              luminance(colour_at(Colours::sequential, (k - 1) / 64.0)));
  for (int k = 1; k <= 32; ++k) {
    EXPECT_GT(luminance(colour_at(Colours::diverging, k / 64.0)),
              luminance(colour_at(Colours::diverging, (k - 1) / 64.0)));
    EXPECT_LT(luminance(colour_at(Colours::diverging, 0.5 + k / 64.0)),
              luminance(colour_at(Colours::diverging, 0.5 + (k - 1) / 64.0)));
  }
  EXPECT_EQ(colour_at(Colours::sequential, NAN), no_value);
  EXPECT_EQ(colour_at(Colours::sequential, 7), colour_at(Colours::sequential, 1));
}

// A bright pixel appears at its place in the world, through a scale and through a homography.
TEST(Raster, ImageIsSeenThroughTheCamera) {
  Mat3 plain, tilted;
  plain << 0.01, 0, 0, 0, -0.01, 0.99, 0, 0, 1;
  tilted << 0.01, 0.001, 0, 0.0005, -0.011, 1.1, 1e-4, 2e-4, 1;
  for (const Mat3& camera : {plain, tilted}) {
    Image image(200, 100, PixelDepth::u16, 65535);
    for (int r = 0; r < 100; ++r)
      for (int c = 0; c < 200; ++c)
        image.row<std::uint16_t>(r)[c] = std::abs(c - 150) <= 3 && std::abs(r - 20) <= 3 ? 60000 : 1000;
    const Box box = image_box(200, 100, camera);
    const Raster r = draw_image(image.view(), camera, box, 400, 50, 200);
    const Eigen::Vector3d q = camera * Eigen::Vector3d(150, 20, 1);
    const Vec2 world = q.head<2>() / q.z();
    const int column = int((world.x() - box.lower.x()) / box.width() * r.width);
    const int row = int((box.upper.y() - world.y()) / box.height() * r.height);
    EXPECT_EQ(at(r, column, row), 0xffc8c8c8u);                              // light: 200
    EXPECT_EQ(at(r, column, (row + r.height / 2) % r.height), 0xff323232u);  // dark: 50
  }
}

}  // namespace
}  // namespace pivnp::plot

// Particles and frames as pixels, and what is computed for the figures.
#include "apps/report/raster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "apps/report/analysis.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/report/synthetic.hpp"

namespace pivnp::report {
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

TEST(Analysis, HistoriesReproduceAffineMotion) {
  ParticleSet set;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) {
      set.id.push_back(j * 5 + i);
      set.label.push_back(0);
      set.x0.emplace_back(i, j);
      set.area.push_back(1);
      set.born.push_back(0);
      set.end.push_back(NAN);
      set.end_reason.push_back(EndReason::none);
    }
  Mat2 G;
  G << 0.25, 0.5, -0.125, 0.0625;
  MotionMemory motion("np", "m", "s", set);
  for (int k = 0; k < 3; ++k) {
    MotionFrame f;
    f.time = k;
    for (const Vec2& x : set.x0) {
      const Vec2 u = k * (G * x + Vec2(1, 2));
      f.u.push_back({float(u.x()), float(u.y())});
      f.F.push_back({1, 0, 0, 1});
      f.status.push_back(ParticleStatus::active);
      f.cov_u.push_back({0.04f, 0.09f, 0});
    }
    motion.add(f);
  }
  const Vec2 inside(1.3, 2.6);
  const auto h = histories(motion, {inside, Vec2(2, 2), Vec2(40, 40)});
  ASSERT_EQ(h.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(h[0].displacement[k], double(k) * (G * inside + Vec2(1, 2)).norm(), 1e-6);
    EXPECT_NEAR(h[1].displacement[k], double(k) * (G * Vec2(2, 2) + Vec2(1, 2)).norm(), 1e-6);
    EXPECT_TRUE(std::isnan(h[2].displacement[k]));
  }
  // u of particle (2, 2) points along (2.5, 1.875), that is (0.8, 0.6): variance 0.64 * 0.04 + 0.36 * 0.09.
  EXPECT_NEAR(h[1].sigma[1], std::sqrt(0.64 * 0.04 + 0.36 * 0.09), 1e-6);
}

TEST(Analysis, TimesAndPoints) {
  SyntheticOptions o;
  o.spacing_m = 0.01;
  const Synthetic s = make_synthetic(o);
  const std::vector<double> times = chosen_times({}, s.content);
  ASSERT_EQ(times.size(), 3u);
  EXPECT_DOUBLE_EQ(times.back(), 0.5);
  EXPECT_LT(times[0], times[1]);
  const std::vector<Vec2> points = chosen_points({}, s.content);
  ASSERT_EQ(points.size(), 3u);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_GT((points[a] - points[b]).norm(), 0.01);
  EXPECT_FALSE(frame_at(*s.content.measured, 0.7));
  EXPECT_EQ(*frame_at(*s.content.measured, 0.301), 15u);
}

TEST(Analysis, PairsAreCounted) {
  const Synthetic s = make_synthetic({});
  const auto pairs = pair_quality(s.content);
  ASSERT_EQ(pairs.size(), 25u);
  for (const PairQuality& q : pairs) {
    EXPECT_EQ(q.valid + q.replaced + q.rejected + q.failed, q.nodes);
    EXPECT_NEAR(q.sigma, 4e-5, 1e-9);
    EXPECT_LE(q.score_low, q.score_median);
  }
  EXPECT_NE(pairs[15].flag, 0);
  EXPECT_EQ(pairs[14].flag, 0);
  EXPECT_LT(pairs[15].share(pairs[15].valid), 0.5);
}

// |u| of the second minus |u| of the first, and the RMS against time, from fields worked by hand.
TEST(Analysis, Differences) {
  SyntheticOptions o;
  o.spacing_m = 0.01;
  const Synthetic s = make_synthetic(o);
  const auto first = snapshots(*s.content.measured, "displacement_magnitude", true, {0.4});
  const auto second = snapshots(*s.content.simulated, "displacement_magnitude", true, {0.4});
  const auto d = field_difference(s.content, "displacement_magnitude", 0.4, first[0]);
  ASSERT_EQ(d.size(), first[0].value.size());
  std::size_t compared = 0;
  for (std::size_t p = 0; p < d.size(); ++p) {
    if (std::isnan(d[p])) continue;
    EXPECT_NEAR(d[p], second[0].value[p] - first[0].value[p], 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 100u);
  EXPECT_TRUE(field_difference(s.content, "strain_vol", 0.4, first[0]).empty());
  const DifferenceHistory h = difference_history(s.content);
  ASSERT_EQ(h.time.size(), 26u);
  EXPECT_NEAR(h.sigma[4], std::sqrt(2.0) * 4e-5 * 2, 1e-9);
  EXPECT_GT(h.rms.back(), h.median.back());
}

}  // namespace
}  // namespace pivnp::report

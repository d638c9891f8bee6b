#include "pivnp/image/masks/mask.hpp"

#include <gmock/gmock.h>

#include <random>

#include "pivnp/core/particles/region.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace {

using test::error_of;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

class Masks : public Scratch {
 protected:
  static constexpr int width = 90, height = 60;
  Mask make(const std::vector<MaskOptions>& masks, const Camera& camera = make_camera({}, width, height)) const {
    std::vector<std::pair<std::string, MaskOptions>> named;
    for (std::size_t k = 0; k < masks.size(); ++k)
      named.emplace_back(std::string("m").append(std::to_string(k)), masks[k]);
    return make_mask(named, camera, width, height, folder_);
  }
  std::string failing(const MaskOptions& mask) const {
    return error_of([&] { make({mask}); });
  }
  static int masked(const Mask& mask) {
    int n = 0;
    for (int r = 0; r < height; ++r)
      for (int c = 0; c < width; ++c) n += !mask.view().usable(c, r);
    return n;
  }
};

TEST_F(Masks, NoneMeansAllUsable) {
  const Mask mask = make({});
  EXPECT_TRUE(mask.empty());
  EXPECT_TRUE(mask.view().usable(0, 0));
}

TEST_F(Masks, ARectangleTakesItsBoundaryIn) {
  const Mask mask = make({{.polygon_px = {{10, 20}, {14, 20}, {14, 22}, {10, 22}}}});
  EXPECT_EQ(masked(mask), 5 * 3);
  EXPECT_FALSE(mask.view().usable(10, 20));
  EXPECT_FALSE(mask.view().usable(14, 22));
  EXPECT_TRUE(mask.view().usable(9, 20));
  EXPECT_TRUE(mask.view().usable(14, 23));
  EXPECT_EQ(masked(make({{.polygon_px = {{10.1, 20.1}, {13.9, 20.1}, {13.9, 21.9}, {10.1, 21.9}}}})), 3 * 1);
}

// Star-shaped polygons round a point, some beyond the image's edge, with corners on and off the pixels' centres.
TEST_F(Masks, RunsAgreeWithTheExactTestAtEveryPixel) {
  RecordProperty("seed", 21);
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE("trial " + std::to_string(trial));
    const bool whole = trial % 2 == 0;  // corners on pixel centres: the hard case
    const Vec2 centre(20 + 50 * unit(random), 10 + 40 * unit(random));
    const int corners = 3 + int(9 * unit(random));
    MaskOptions options;
    std::vector<Vec2> vertices;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * M_PI * (k + 0.8 * unit(random)) / corners, radius = 5 + 45 * unit(random);
      Vec2 v = centre + radius * Vec2(std::cos(angle), std::sin(angle));
      if (whole) v = v.array().round();
      vertices.push_back(v);
      options.polygon_px.push_back({v.x(), v.y()});
    }
    std::unique_ptr<Polygon> polygon;
    try {
      polygon = std::make_unique<Polygon>(vertices, "trial");
    } catch (const InputError&) {
      continue;  // rounding made it touch itself
    }
    for (const bool invert : {false, true}) {
      options.invert = invert;
      const Mask mask = make({options});
      for (int r = 0; r < height; ++r)
        for (int c = 0; c < width; ++c)
          ASSERT_EQ(mask.view().usable(c, r), polygon->contains(Vec2(c, r)) == invert) << c << " " << r << invert;
    }
  }
}

TEST_F(Masks, CirclesByDistance) {
  const Mask mask = make({{.circle_px = {30, 20, 5}}});
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      ASSERT_EQ(mask.view().usable(c, r), (c - 30) * (c - 30) + (r - 20) * (r - 20) > 25) << c << " " << r;
  EXPECT_EQ(masked(make({{.circle_px = {30, 20, 5}, .invert = true}})) + masked(mask), width * height);
  EXPECT_EQ(masked(make({{.circle_px = {-100, 20, 5}}})), 0);
}

TEST_F(Masks, WorldPolygonsGoThroughTheCamera) {
  const Camera scale = make_camera({.metres_per_pixel = 0.01, .origin_px = Pair{10, 50}}, width, height);
  // x 0.1 .. 0.3, y 0.2 .. 0.3: columns 20 .. 40, rows 20 .. 30. Drawn a little larger, off the centres.
  const Mask mask = make({{.polygon_m = {{0.099, 0.199}, {0.301, 0.199}, {0.301, 0.301}, {0.099, 0.301}}}}, scale);
  EXPECT_EQ(masked(mask), 21 * 11);
  EXPECT_FALSE(mask.view().usable(20, 30));
  EXPECT_FALSE(mask.view().usable(40, 20));

  Mat3 m;
  m << 0.01, 0.001, -0.1, 0.0005, -0.012, 0.6, 0.0004, -0.002, 1;
  const Camera oblique(m, 0, "m");
  const std::vector<Vec2> world = {{0.1, 0.1}, {0.55, 0.15}, {0.5, 0.5}, {0.13, 0.4}};
  MaskOptions options;
  for (const Vec2& x : world) options.polygon_m.push_back({x.x(), x.y()});
  const Mask seen = make({options}, oblique);
  const Polygon polygon(world, "t");
  EXPECT_GT(masked(seen), 100);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      ASSERT_EQ(!seen.view().usable(c, r), polygon.contains(oblique.to_world(Vec2(c, r)))) << c << " " << r;
}

TEST_F(Masks, ImagesLeaveOutTheirZeros) {
  cv::Mat image(height, width, CV_8U, cv::Scalar(255));
  image(cv::Rect(3, 4, 10, 6)).setTo(0);
  write("m.png", image);
  const Mask mask = make({{.image = "m.png"}});
  EXPECT_EQ(masked(mask), 60);
  EXPECT_FALSE(mask.view().usable(3, 4));
  EXPECT_EQ(masked(make({{.image = "m.png", .invert = true}})), width * height - 60);
  cv::Mat deep(height, width, CV_16U, cv::Scalar(1));
  deep.at<std::uint16_t>(2, 2) = 0;
  write("d.tif", deep);
  EXPECT_EQ(masked(make({{.image = "d.tif"}})), 1);
}

TEST_F(Masks, TogetherTheyLeaveOutWhatAnyLeavesOut) {
  const MaskOptions circle{.circle_px = {30, 20, 5}}, box{.polygon_px = {{60, 30}, {70, 30}, {70, 40}, {60, 40}}};
  EXPECT_EQ(masked(make({circle, box})), masked(make({circle})) + masked(make({box})));
}

TEST_F(Masks, BadMasksAreNamed) {
  EXPECT_THAT(failing({}), AllOf(HasSubstr("mask.m0"), HasSubstr("no shape")));
  EXPECT_THAT(failing({.circle_px = {1, 1, 1}, .image = "x.png"}),
              AllOf(HasSubstr("several shapes"), HasSubstr("circle_px, image")));
  EXPECT_THAT(failing({.polygon_px = {{0, 0}, {9, 9}, {9, 0}, {0, 9}}}),
              AllOf(HasSubstr("mask.m0.polygon_px"), HasSubstr("crosses")));
  EXPECT_THAT(failing({.polygon_m = {{0, 0}, {9, 9}}}), HasSubstr("mask.m0.polygon_m"));
  EXPECT_THAT(failing({.circle_px = {1, 1}}), HasSubstr("found 2 numbers"));
  EXPECT_THAT(failing({.circle_px = {1, 1, -2}}), HasSubstr("radius"));
  EXPECT_THAT(failing({.image = "gone.png"}), AllOf(HasSubstr("mask.m0.image"), HasSubstr("no such file")));
  write("small.png", cv::Mat(10, 20, CV_8U, cv::Scalar(1)));
  EXPECT_THAT(failing({.image = "small.png"}), AllOf(HasSubstr("is 20x10"), HasSubstr("the frames are 90x60")));
  EXPECT_THAT(failing({.circle_px = {45, 30, 500}}), HasSubstr("nothing of the image is left"));
}

}  // namespace
}  // namespace pivnp::image

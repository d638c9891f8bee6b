#include "pivnp/image/camera/camera.hpp"

#include <gmock/gmock.h>

#include <random>

#include "scratch.hpp"

namespace pivnp::image {
namespace {

using test::error_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int width = 1920, height = 1080;

// An oblique view of a 0.3 m wide plane.
Mat3 oblique() {
  Mat3 m;
  m << 1.6e-4, 1.1e-5, -0.02, -0.8e-5, -1.9e-4, 0.19, 2.0e-5, -1.5e-4, 1.0;
  return m;
}

CameraOptions targets(const Mat3& world_from_pixel, const std::vector<Vec2>& pixels, double noise_m = 0, int seed = 1) {
  std::mt19937 random{unsigned(seed)};
  std::normal_distribution<double> normal;
  const Camera camera(world_from_pixel, 0, "m");
  CameraOptions options;
  for (const Vec2& p : pixels) {
    Vec2 x = camera.to_world(p);
    if (noise_m > 0) x += noise_m * Vec2(normal(random), normal(random));
    options.points_px.push_back({p.x(), p.y()});
    options.points_m.push_back({x.x(), x.y()});
  }
  return options;
}

std::vector<Vec2> lattice(int n) {
  std::vector<Vec2> out;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) out.emplace_back(100 + 1700.0 * i / (n - 1), 60 + 950.0 * j / (n - 1));
  return out;
}

void expect_invertible_and_smooth(const Camera& camera) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> column(0, width - 1), row(0, height - 1);
  for (int k = 0; k < 200; ++k) {
    const Vec2 p(column(random), row(random));
    EXPECT_LT((camera.to_pixel(camera.to_world(p)) - p).norm(), 1e-9);
    const Mat2 exact = camera.jacobian(p);
    Mat2 numeric;
    const double h = 0.01;
    for (int a = 0; a < 2; ++a)
      numeric.col(a) = (camera.to_world(p + h * Vec2::Unit(a)) - camera.to_world(p - h * Vec2::Unit(a))) / (2 * h);
    EXPECT_LT((numeric - exact).norm(), 1e-6 * exact.norm());
  }
}

TEST(Camera, PixelsAloneHaveTheirOriginAtTheLowerLeft) {
  const Camera camera = make_camera({}, width, height);
  EXPECT_EQ(camera.to_world({0, height - 1}), Vec2(0, 0));
  EXPECT_EQ(camera.to_world({7, 9}), Vec2(7, height - 10));
  EXPECT_EQ(camera.length_unit(), "px");
  EXPECT_EQ(camera.residual(), 0);
  EXPECT_TRUE(camera.plain());
  EXPECT_EQ(make_camera({.origin_px = Pair{10, 20}}, width, height).to_world({7, 9}), Vec2(-3, 11));
  EXPECT_EQ(Camera().to_world({7, 9}), Vec2(7, -9));
  EXPECT_TRUE(Camera().plain());
}

TEST(Camera, ScaleAndOrigin) {
  const Camera camera = make_camera({.metres_per_pixel = 2e-4, .origin_px = Pair{100, 900}}, width, height);
  EXPECT_LT((camera.to_world({100, 900})).norm(), 1e-15);
  EXPECT_LT((camera.to_world({600, 400}) - Vec2(0.1, 0.1)).norm(), 1e-15);
  EXPECT_LT((camera.to_pixel({0.1, 0.1}) - Vec2(600, 400)).norm(), 1e-9);
  EXPECT_TRUE(camera.plain());
  EXPECT_EQ(camera.length_unit(), "m");
  EXPECT_EQ(make_camera({.metres_per_pixel = 1 / 790.0, .length_unit = "D"}, width, height).length_unit(), "D");
  EXPECT_LT(make_camera({.metres_per_pixel = 2e-4}, width, height).to_world({0, height - 1}).norm(), 1e-15);
  Mat2 expected;
  expected << 2e-4, 0, 0, -2e-4;
  EXPECT_LT((camera.jacobian({5, 6}) - expected).norm(), 1e-18);
  expect_invertible_and_smooth(camera);
}

TEST(Camera, FourExactTargetsGiveTheHomography) {
  const Camera camera =
      make_camera(targets(oblique(), {{100, 80}, {1800, 60}, {1750, 1010}, {140, 960}}), width, height);
  const Camera truth(oblique(), 0, "m");
  EXPECT_FALSE(camera.plain());
  EXPECT_LT(camera.residual(), 1e-14);
  for (const Vec2& p : lattice(5)) EXPECT_LT((camera.to_world(p) - truth.to_world(p)).norm(), 1e-12);
  expect_invertible_and_smooth(camera);
}

TEST(Camera, ASquareOnHomographyIsTheScale) {
  const Camera plain = make_camera({.metres_per_pixel = 2e-4}, width, height);
  const Camera fitted = make_camera(targets(plain.world_from_pixel(), lattice(3)), width, height);
  EXPECT_LT((fitted.world_from_pixel() - plain.world_from_pixel()).norm(), 1e-11);
}

// Least squares: the residual is the noise less the eight fitted numbers; no small change of the camera does better.
TEST(Camera, NoisyTargetsAreFittedByLeastSquaresInTheWorld) {
  const double noise_m = 1e-4;
  const Mat2 unit = Mat2::Identity();
  for (int seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const CameraOptions options = targets(oblique(), lattice(7), noise_m, seed);
    const Camera camera = make_camera(options, width, height);
    const double n = double(options.points_px.size());
    const double expected = noise_m * std::sqrt((2 * n - 8) / n);
    EXPECT_NEAR(camera.residual(), expected, 0.25 * expected);

    auto rms = [&](const Mat3& m) {
      const Camera other(m, 0, "m");
      double sum = 0;
      for (std::size_t k = 0; k < options.points_px.size(); ++k) {
        const Pair &p = options.points_px[k], &x = options.points_m[k];
        sum += (unit * (other.to_world({p[0], p[1]}) - Vec2(x[0], x[1]))).squaredNorm();
      }
      return std::sqrt(sum / n);
    };
    EXPECT_NEAR(rms(camera.world_from_pixel()), camera.residual(), 1e-9 * noise_m);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        for (const double change : {-1e-5, 1e-5}) {
          Mat3 moved = camera.world_from_pixel();
          moved(r, c) *= 1 + change;
          if (r == 2 && c == 2) continue;
          EXPECT_GE(rms(moved), camera.residual() * (1 - 1e-12)) << r << c;
        }
  }
}

TEST(Camera, ALongNarrowFieldOfTargetsIsNoLine) {
  const Camera camera =
      make_camera(targets(oblique(), {{0, 500}, {1919, 505}, {1910, 520}, {5, 515}, {900, 509}}), width, height);
  EXPECT_LT((camera.to_world({960, 510}) - Camera(oblique(), 0, "m").to_world({960, 510})).norm(), 1e-11);
}

TEST(Camera, BeyondTheHorizonThereIsNoWorld) {
  const Camera camera(oblique(), 0, "m");  // the horizon runs near row 6667
  EXPECT_TRUE(camera.to_world({0, 6600}).allFinite());
  EXPECT_FALSE(camera.to_world({0, 6700}).allFinite());
}

TEST(Camera, BadTargetsAreNamed) {
  const std::vector<Vec2> square = {{100, 80}, {1800, 60}, {1750, 1010}, {140, 960}};
  auto failing = [](const CameraOptions& options) { return error_of([&] { make_camera(options, width, height); }); };
  CameraOptions good = targets(oblique(), square);
  CameraOptions o = good;
  o.points_m.pop_back();
  EXPECT_THAT(failing(o), AllOf(HasSubstr("points_px has 4"), HasSubstr("points_m has 3")));
  o.points_px.pop_back();
  EXPECT_THAT(failing(o), HasSubstr("four or more targets, found 3"));
  o = good;
  o.points_m.clear();
  EXPECT_THAT(failing(o), HasSubstr("points_m has 0"));
  o = good;
  o.points_px[2] = o.points_px[0];
  EXPECT_THAT(failing(o), HasSubstr("points_px: targets 1 and 3 are the same point"));
  o = good;
  o.points_m[3] = o.points_m[1];
  EXPECT_THAT(failing(o), HasSubstr("points_m: targets 2 and 4 are the same point"));
  o = good;
  o.metres_per_pixel = 1e-4;
  EXPECT_THAT(failing(o), HasSubstr("both given"));
  o = good;
  o.origin_px = Pair{0, 0};
  EXPECT_THAT(failing(o), HasSubstr("both given"));
  o = good;
  std::swap(o.points_m[0], o.points_m[1]);
  EXPECT_THAT(failing(o), HasSubstr("same order"));
  EXPECT_THAT(failing(targets(oblique(), {{100, 80}, {950, 70}, {1800, 60}, {140, 960}})),
              HasSubstr("targets 1, 2 and 3 lie on a line"));
  EXPECT_THAT(failing(targets(oblique(), {{0, 0}, {100, 50}, {200, 100}, {400, 200}, {800, 400}})),
              HasSubstr("lie on one line"));
  EXPECT_THAT(failing(targets(oblique(), {{0, 0}, {100, 50}, {200, 100}, {400, 200}, {800, 900}})),
              HasSubstr("too many targets lie on one line"));
  EXPECT_THAT(failing({.metres_per_pixel = 0.0}), HasSubstr("camera.metres_per_pixel"));
  EXPECT_THAT(error_of([] { Camera(Mat3::Zero(), 0, "m"); }), HasSubstr("cannot be inverted"));
}

}  // namespace
}  // namespace pivnp::image

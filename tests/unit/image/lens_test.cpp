// Lens, window and calibration board.
//   criterion: image -> ray -> image returns every pixel within 1e-6 px; the window's rays are Snell's; a lens found from
//     drawn pictures of a board maps the image as the true one does within .02 px, once both look at one plane.
#include "pivnp/image/camera/lens.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "pivnp/image/calibration/calibration.hpp"
#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/camera/homography.hpp"
#include "pivnp/image/masks/mask.hpp"
#include "pivnp/image/rectify.hpp"
#include "scratch.hpp"

namespace pivnp::image {
namespace lens_tests {

using test::error_of;
using ::testing::HasSubstr;

constexpr int width = 640, height = 480;

Lens brown(std::vector<double> k) { return {LensModel::brown, {620, 618}, {323, 236}, std::move(k), {}}; }
Lens fisheye() { return {LensModel::fisheye, {330, 330}, {318, 242}, {0.04, -0.01, 0.004, -0.001}, {}}; }

double round_trip(const Lens& lens) {
  double most = 0;
  for (int r = 0; r < height; r += 7)
    for (int c = 0; c < width; c += 7) {
      const Vec2 p(c + 0.3, r + 0.1), back = lens.to_pixel(lens.to_ideal(p));
      most = std::max(most, std::isfinite(back.x()) ? (back - p).norm() : INFINITY);
    }
  return most;
}

TEST(Lens, ReturnsEveryPixel) {
  EXPECT_LT(round_trip(brown({-0.06, 0.01})), 1e-6);
  EXPECT_LT(round_trip(brown({-0.2, 0.05, 1e-3, -2e-3, 0.01})), 1e-6);
  EXPECT_LT(round_trip(fisheye()), 1e-6);
  EXPECT_LT(round_trip(Lens(LensModel::none, {600, 600}, {320, 240}, {}, {0.03, 0.5, 1.49})), 1e-6);
  EXPECT_LT(round_trip(Lens(LensModel::fisheye, {330, 330}, {318, 242}, {0.04}, {0.03, 0.2, 1.52})), 1e-6);
}

TEST(Lens, DistortsAsBrown) {
  // By hand: x = .3, y = .2, r2 = .13; radial 1 - .1 .13; tangential 2 p1 x y + p2 (r2 + 2 x^2) ...
  const Lens lens(LensModel::brown, {100, 100}, {0, 0}, {-0.1, 0, 0.01, 0.02}, {});
  const Vec2 p = lens.to_pixel({30, 20});
  EXPECT_NEAR(p.x(), 100 * (0.3 * 0.987 + 2 * 0.01 * 0.06 + 0.02 * (0.13 + 0.18)), 1e-9);
  EXPECT_NEAR(p.y(), 100 * (0.2 * 0.987 + 0.01 * (0.13 + 0.08) + 2 * 0.02 * 0.06), 1e-9);
}

TEST(Lens, RefractsAsSnell) {
  const double D = 0.4, t = 0.05, n = 1.5, angle = 0.5;
  const Lens lens(LensModel::none, {1000, 1000}, {0, 0}, {}, {t, D, n});
  const double inside = std::asin(std::sin(angle) / n), seen = D * std::tan(angle) + t * std::tan(inside);
  // The plane seen without the window under the tangent that the same scale on the axis gives.
  const Vec2 ideal = lens.to_ideal({1000 * std::tan(angle), 0});
  EXPECT_NEAR(ideal.x() / 1000 * (D + t / n), seen, 1e-12);
}

TEST(Lens, SaysWhereTheModelFolds) {
  CameraOptions o;
  o.lens = LensModel::brown;
  o.focal_px = Pair{300, 300};
  o.distortion = {-0.6};
  EXPECT_THAT(error_of([&] { make_camera(o, width, height); }), HasSubstr("folds over within the image"));
  o.distortion = {-0.06};
  EXPECT_NO_THROW(make_camera(o, width, height));
  o.focal_px.reset();
  EXPECT_THAT(error_of([&] { make_camera(o, width, height); }), HasSubstr("camera.focal_px: missing"));
}

TEST(Lens, CameraGoesThroughIt) {
  CameraOptions o;
  o.lens = LensModel::brown;
  o.focal_px = Pair{620, 620};
  o.distortion = {-0.06};
  o.metres_per_pixel = 1e-3;
  o.lens_rms_px = 0.1;
  const Camera camera = make_camera(o, width, height);
  EXPECT_FALSE(camera.plain());
  EXPECT_NEAR(camera.residual(), 1e-4, 1e-12);
  const Vec2 p(600.2, 33.7), x = camera.to_world(p);
  EXPECT_LT((camera.to_pixel(x) - p).norm(), 1e-6);
  const double h = 1e-3;
  const Vec2 along = (camera.to_world(p + Vec2(h, 0)) - camera.to_world(p - Vec2(h, 0))) / (2 * h);
  EXPECT_LT((camera.jacobian(p).col(0) - along).norm(), 1e-9);
  // Straight lines of the world are straight again in what is drawn.
  Image grey(width, height, PixelDepth::u8, 255);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      grey.row<std::uint8_t>(r)[c] = std::fmod(camera.to_world({double(c), double(r)}).x() + 1, 0.1) < 0.05 ? 200 : 20;
  const DrawnFrame drawn = drawn_frame(std::move(grey), camera);
  int off = 0, all = 0;
  for (int r = 60; r < drawn.image.height() - 60; r += 5)
    for (int c = 60; c < drawn.image.width() - 60; ++c) {
      const Eigen::Vector3d w = drawn.world_from_pixel * Eigen::Vector3d(c, r, 1);
      const double phase = std::fmod(w.x() / w.z() + 1, 0.1);
      if (std::abs(phase - 0.05) < 0.003 || phase < 0.003 || phase > 0.097) continue;
      const Image& image = drawn.image;
      off += (image.view().row<std::uint8_t>(r)[c] > 110) != (phase < 0.05), ++all;
    }
  EXPECT_GT(all, 10000);
  EXPECT_EQ(off, 0);
}

TEST(Lens, BendsMaskSides) {
  CameraOptions o;
  o.lens = LensModel::brown;
  o.focal_px = Pair{300, 300};
  o.distortion = {-0.05};
  o.metres_per_pixel = 1.0;
  const Camera camera = make_camera(o, width, height);
  MaskOptions m;
  const Vec2 a = camera.to_world({100, 60}), b = camera.to_world({540, 60});  // one straight side between two pixels
  m.polygon_m = {{a.x(), a.y()}, {b.x(), b.y()}, {b.x(), b.y() + 30}, {a.x(), a.y() + 30}};
  const Mask mask = make_mask({{"m", m}}, camera, width, height, ".");
  const Vec2 middle = camera.to_pixel((a + b) / 2);
  EXPECT_GT(std::abs(middle.y() - 60), 3);  // the side is bent
  EXPECT_TRUE(mask.view().usable(int(middle.x()), int(middle.y()) + 2));
  EXPECT_FALSE(mask.view().usable(int(middle.x()), int(middle.y()) - 2));
}

// A board 9 x 6 seen through `lens`, tilted and shifted; each pixel is the mean of 5 x 5 points.
Image board_image(const Lens& lens, double tilt_x, double tilt_y, double shift_x, double shift_y, double distance) {
  const double cx = std::cos(tilt_x), sx = std::sin(tilt_x), cy = std::cos(tilt_y), sy = std::sin(tilt_y);
  Mat3 pose;  // board (u, v, 1) -> camera
  pose.col(0) << cy, sx * sy, -cx * sy;
  pose.col(1) << 0, cx, sx;
  pose.col(2) << shift_x, shift_y, distance;
  const Mat3 back = pose.inverse();
  Image out(width, height, PixelDepth::u8, 255);
  constexpr int fine = 5;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      double sum = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const Vec2 p(c + (k % fine + 0.5) / fine - 0.5, r + (k / fine + 0.5) / fine - 0.5);
        const Vec2 ray = (lens.to_ideal(p) - lens.centre()).cwiseQuotient(lens.focal());
        const Eigen::Vector3d at = back * Eigen::Vector3d(ray.x(), ray.y(), 1);
        const double u = at.x() / at.z() + 5, v = at.y() / at.z() + 3.5;
        const bool on = u > 0 && v > 0 && u < 10 && v < 7;
        sum += on && (int(u) + int(v)) % 2 == 0 ? 25 : 225;
      }
      out.row<std::uint8_t>(r)[c] = std::uint8_t(std::lround(sum / (fine * fine)));
    }
  return out;
}

// Greatest distance between what both lenses see of one plane, over the part of the image with corners (they span columns 44
// to 587 and rows 71 to 412 of the fish-eye), px.
double apart(const Lens& truth, const Lens& found, double margin) {
  std::vector<Vec2> from, to;
  for (double r = margin; r < height - margin; r += 40)
    for (double c = margin; c < width - margin; c += 40) from.push_back(truth.to_ideal({c, r})), to.push_back(found.to_ideal({c, r}));
  const Mat3 H = fit_homography(from, to).world_from_pixel;
  double most = 0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Eigen::Vector3d w = H * Eigen::Vector3d(from[k].x(), from[k].y(), 1);
    most = std::max(most, (found.to_pixel(w.head<2>() / w.z()) - found.to_pixel(to[k])).norm());
  }
  return most;
}

Calibration from_views(const Lens& lens, double near) {
  std::vector<BoardView> views;
  const Board board{9, 6, 1.0};
  for (const auto& [a, b, x, y] : std::vector<std::array<double, 4>>{{0.0, 0.0, 0.0, 0.0}, {0.45, 0.1, -1.2, -0.8}, {-0.45, 0.1, 1.2, 0.8},
                                                                     {0.1, 0.5, 1.3, -0.7}, {0.1, -0.5, -1.3, 0.7}, {0.3, 0.3, 0.4, -0.9}})
    views.push_back({"drawn", board_corners(board_image(lens, a, b, x, y, near).view(), board), {}, 0});
  return calibrate_views(std::move(views), width, height, board, lens.model(), false);
}

TEST(Calibration, FindsALens) {
  const Lens truth = brown({-0.06, 0.01, 5e-4, -3e-4});
  const Calibration found = from_views(truth, 12.5);
  EXPECT_EQ(found.used(), 6);
  EXPECT_LT(found.rms_px, 0.06);
  EXPECT_NEAR(found.coefficients[0], -0.06, 0.004);
  EXPECT_LT(apart(truth, Lens(LensModel::brown, found.focal, found.centre, found.coefficients, {}), 100), 0.02);
}

TEST(Calibration, FindsAFishEye) {
  const Calibration found = from_views(fisheye(), 6.6);
  EXPECT_GE(found.used(), 5);
  EXPECT_LT(found.rms_px, 0.06);
  EXPECT_LT(apart(fisheye(), Lens(LensModel::fisheye, found.focal, found.centre, found.coefficients, {}), 100), 0.02);
}

TEST(Calibration, SaysWhatIsMissing) {
  const Image empty = board_image(brown({}), 0, 0, 100, 100, 10);
  const Board board{9, 6, 1.0};
  std::vector<BoardView> views(4, BoardView{"blank", board_corners(empty.view(), board), {}, 0});
  EXPECT_THAT(error_of([&] { calibrate_views(views, width, height, board, LensModel::brown, false); }),
              HasSubstr("found as a whole in 0 of 4 images, expected at least 3"));
}

}  // namespace lens_tests
}  // namespace pivnp::image

#include "pivnp/image/camera.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/image/homography.hpp"

namespace pivnp::image {

namespace {

Mat3 scale_and_flip(double length_per_pixel, const Vec2& origin_px) {
  const double s = length_per_pixel;
  Mat3 m;
  m << s, 0, -s * origin_px.x(), 0, -s, s * origin_px.y(), 0, 0, 1;
  return m;
}

// Inverse by cofactors: the third coordinate keeps its sign, and a plain scale inverts without rounding beyond 1/s.
Mat3 inverse(const Mat3& m) {
  const double determinant = m.determinant();
  if (!(std::abs(determinant) > 0) || !std::isfinite(determinant))
    throw InputError("camera: the matrix world_from_pixel cannot be inverted");
  return m.inverse();
}

Vec2 mapped(const Mat3& m, const Vec2& x) {
  const double w = m(2, 0) * x.x() + m(2, 1) * x.y() + m(2, 2);
  if (!(w > 0)) return Vec2::Constant(std::numeric_limits<double>::quiet_NaN());
  return Vec2(m(0, 0) * x.x() + m(0, 1) * x.y() + m(0, 2), m(1, 0) * x.x() + m(1, 1) * x.y() + m(1, 2)) / w;
}

Camera plain_camera(const CameraOptions& options, int height) {
  const Pair origin = options.origin_px.value_or(Pair{0.0, double(height - 1)});
  if (!std::isfinite(origin[0]) || !std::isfinite(origin[1]))
    throw InputError("camera.origin_px: expected two finite numbers (column, row)");
  const double scale = options.metres_per_pixel.value_or(1.0);
  if (!(scale > 0 && std::isfinite(scale)))
    throw InputError("camera.metres_per_pixel: found " + std::to_string(scale) + ", expected a number above 0");
  const std::string unit = options.metres_per_pixel ? options.length_unit : "px";
  return Camera(scale_and_flip(scale, Vec2(origin[0], origin[1])), 0.0, unit);
}

}  // namespace

Camera::Camera() : Camera(scale_and_flip(1.0, Vec2::Zero()), 0.0, "px") {}

Camera::Camera(const Mat3& world_from_pixel, double residual, std::string length_unit)
    : world_from_pixel_(world_from_pixel),
      pixel_from_world_(inverse(world_from_pixel)),
      residual_(residual),
      length_unit_(std::move(length_unit)) {}

Vec2 Camera::to_world(const Vec2& pixel) const { return mapped(world_from_pixel_, pixel); }

Vec2 Camera::to_pixel(const Vec2& world) const { return mapped(pixel_from_world_, world); }

Mat2 Camera::jacobian(const Vec2& pixel) const {
  const Mat3& m = world_from_pixel_;
  const Vec2 x = to_world(pixel);
  const double w = m(2, 0) * pixel.x() + m(2, 1) * pixel.y() + m(2, 2);
  return (m.topLeftCorner<2, 2>() - x * m.bottomLeftCorner<1, 2>()) / w;
}

bool Camera::plain() const {
  const Mat3& m = world_from_pixel_;
  return m(0, 0) > 0 && m(1, 1) == -m(0, 0) && m(0, 1) == 0 && m(1, 0) == 0 && m(2, 0) == 0 && m(2, 1) == 0 &&
         m(2, 2) == 1;
}

Camera make_camera(const CameraOptions& options, int width, int height) {
  if (width < 1 || height < 1) throw InputError("camera: the image has no pixels");
  if (options.length_unit.empty()) throw InputError("camera.length_unit: expected the name of a unit, found nothing");
  if (options.points_px.empty() && options.points_m.empty()) return plain_camera(options, height);
  if (options.metres_per_pixel)
    throw InputError("camera: metres_per_pixel and points_px are both given; expected one of the two");
  if (options.origin_px)
    throw InputError("camera: origin_px and points_px are both given; with targets the origin is that of points_m");
  const Homography fit = fit_homography(positions_of(options.points_px), positions_of(options.points_m));
  return Camera(fit.world_from_pixel, fit.residual, options.length_unit);
}

}  // namespace pivnp::image

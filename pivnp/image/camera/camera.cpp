#include "pivnp/image/camera/camera.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/image/camera/homography.hpp"

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

Lens lens_of(const CameraOptions& options, int width, int height) {
  const bool window = options.window_thickness_m > 0;
  if (options.lens == LensModel::none && !window) {
    if (!options.distortion.empty()) throw InputError("camera.distortion: given without camera.lens; expected brown or fisheye");
    return {};
  }
  if (!options.focal_px)
    throw InputError(std::string("camera.focal_px: missing; expected it with ") + (window ? "a window" : "a lens") +
                     ", as `pivnp calibrate` finds it");
  if (window && !options.window_distance_m)
    throw InputError("camera.window_distance_m: missing; expected it with camera.window_thickness_m");
  const Pair centre = options.centre_px.value_or(Pair{(width - 1) / 2.0, (height - 1) / 2.0});
  const Lens lens(options.lens, {(*options.focal_px)[0], (*options.focal_px)[1]}, {centre[0], centre[1]}, options.distortion,
                  {options.window_thickness_m, options.window_distance_m.value_or(1.0), options.window_index});
  for (const double column : {0.0, width - 1.0})
    for (const double row : {0.0, height - 1.0})
      if (!lens.to_ideal({column, row}).allFinite())
        throw InputError("camera.distortion: the model folds over within the image: no ray leads to pixel (" +
                         std::to_string(int(column)) + ", " + std::to_string(int(row)) +
                         "); expected coefficients that hold to the corners (focal_px and centre_px are those of this image size?)");
  return lens;
}

Camera plain_camera(const CameraOptions& options, int height, Lens lens) {
  const Pair origin = options.origin_px.value_or(Pair{0.0, double(height - 1)});
  if (!std::isfinite(origin[0]) || !std::isfinite(origin[1]))
    throw InputError("camera.origin_px: expected two finite numbers (column, row)");
  const double scale = options.metres_per_pixel.value_or(1.0);
  if (!(scale > 0 && std::isfinite(scale)))
    throw InputError("camera.metres_per_pixel: found " + std::to_string(scale) + ", expected a number above 0");
  const std::string unit = options.metres_per_pixel ? options.length_unit : "px";
  // The origin is a pixel of the image.
  const Vec2 ideal = lens.to_ideal(Vec2(origin[0], origin[1]));
  if (!ideal.allFinite()) throw InputError("camera.origin_px: no ray of the lens leads to this pixel; expected one in the image");
  return Camera(scale_and_flip(scale, ideal), options.lens_rms_px * scale, unit, std::move(lens));
}

}  // namespace

Camera::Camera() : Camera(scale_and_flip(1.0, Vec2::Zero()), 0.0, "px") {}

Camera::Camera(const Mat3& world_from_pixel, double residual, std::string length_unit, Lens lens)
    : world_from_pixel_(world_from_pixel),
      pixel_from_world_(inverse(world_from_pixel)),
      residual_(residual),
      length_unit_(std::move(length_unit)),
      lens_(std::move(lens)) {}

Vec2 Camera::to_world(const Vec2& pixel) const { return mapped(world_from_pixel_, lens_.to_ideal(pixel)); }

Vec2 Camera::to_pixel(const Vec2& world) const { return lens_.to_pixel(mapped(pixel_from_world_, world)); }

Camera Camera::after(const Mat3& moved) const {
  return Camera(world_from_pixel_ * moved.inverse(), residual_, length_unit_, lens_);
}

Mat2 Camera::jacobian(const Vec2& pixel) const {
  const Mat3& m = world_from_pixel_;
  const Vec2 ideal = lens_.to_ideal(pixel), x = mapped(m, ideal);
  const double w = m(2, 0) * ideal.x() + m(2, 1) * ideal.y() + m(2, 2);
  const Mat2 J = (m.topLeftCorner<2, 2>() - x * m.bottomLeftCorner<1, 2>()) / w;
  return lens_.straight() ? J : Mat2(J * lens_.jacobian(pixel));
}

bool Camera::plain() const {
  const Mat3& m = world_from_pixel_;
  return lens_.straight() && m(0, 0) > 0 && m(1, 1) == -m(0, 0) && m(0, 1) == 0 && m(1, 0) == 0 && m(2, 0) == 0 && m(2, 1) == 0 &&
         m(2, 2) == 1;
}

Camera make_camera(const CameraOptions& options, int width, int height) {
  if (width < 1 || height < 1) throw InputError("camera: the image has no pixels");
  if (options.length_unit.empty()) throw InputError("camera.length_unit: expected the name of a unit, found nothing");
  Lens lens = lens_of(options, width, height);
  if (options.points_px.empty() && options.points_m.empty()) return plain_camera(options, height, std::move(lens));
  if (options.metres_per_pixel)
    throw InputError("camera: metres_per_pixel and points_px are both given; expected one of the two");
  if (options.origin_px)
    throw InputError("camera: origin_px and points_px are both given; with targets the origin is that of points_m");
  std::vector<Vec2> ideal = positions_of(options.points_px);
  for (Vec2& p : ideal) p = lens.to_ideal(p);
  const Homography fit = fit_homography(ideal, positions_of(options.points_m));
  Camera camera(fit.world_from_pixel, 0.0, options.length_unit, lens);
  const double pixel = std::sqrt(std::abs(camera.jacobian({(width - 1) / 2.0, (height - 1) / 2.0}).determinant()));
  const double residual = options.lens_rms_px > 0 ? std::hypot(fit.residual, options.lens_rms_px * pixel) : fit.residual;
  return Camera(fit.world_from_pixel, residual, options.length_unit, std::move(lens));
}

}  // namespace pivnp::image

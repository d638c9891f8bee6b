// Between pixels and the world.
#pragma once

#include <optional>
#include <string>

#include "pivnp/core/math.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::image {

struct CameraOptions {
  std::optional<double> metres_per_pixel = {};
  std::optional<Pair> origin_px = {};
  Points points_px = {};
  Points points_m = {};
  std::string length_unit = "m";

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("metres_per_pixel", self.metres_per_pixel,
          OptionInfo{.unit = "m/px", .text = "scale of a square-on camera (left out, and no points: lengths are in px)",
                     .min = 0, .above_min = true});
    visit("origin_px", self.origin_px,
          OptionInfo{.unit = "px",
                     .text = "pixel (column, row) of the world's (0, 0) (left out: the lower left pixel)"});
    visit("points_px", self.points_px,
          OptionInfo{.unit = "px", .text = "four or more targets in the image, for a homography"});
    visit("points_m", self.points_m,
          OptionInfo{.unit = "m", .text = "the same targets in the world, in the same order"});
    visit("length_unit", self.length_unit,
          OptionInfo{.text = "name of the unit that metres_per_pixel and points_m are in (m, or a length of the scene)"});
  }
};

/// Plane-to-plane camera: world = dehomogenised(world_from_pixel * (column, row, 1)). World y is up, pixel centres lie
/// on whole numbers. The third coordinate is positive on the visible side; a point at or beyond the horizon is NaN.
class Camera {
 public:
  Camera();  // pixels: world = (column, -row)
  /// Throws InputError if the matrix cannot be inverted.
  Camera(const Mat3& world_from_pixel, double residual, std::string length_unit);

  Vec2 to_world(const Vec2& pixel) const;
  Vec2 to_pixel(const Vec2& world) const;
  /// d world / d pixel at a pixel.
  Mat2 jacobian(const Vec2& pixel) const;
  const Mat3& world_from_pixel() const { return world_from_pixel_; }
  double residual() const { return residual_; }  // RMS of the targets, length unit; 0 for a plain scale
  const std::string& length_unit() const { return length_unit_; }
  bool plain() const;  // a scale, a shift and the flip of y

 private:
  Mat3 world_from_pixel_, pixel_from_world_;
  double residual_ = 0;
  std::string length_unit_ = "px";
};

/// Scale and origin, or a homography from targets (see homography.hpp), or pixels: world = (column - origin column,
/// origin row - row), unit "px" whatever length_unit says. Without an origin the world's (0, 0) is the centre of the
/// lower left pixel, (0, height - 1). A homography's residual is the RMS distance of the targets in the world.
/// Throws InputError: lists of different length, fewer than four points, points on a line, a target given twice, the
/// lists in different order, both ways given at once.
Camera make_camera(const CameraOptions& options, int width, int height);

}  // namespace pivnp::image

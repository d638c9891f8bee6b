// Between pixels and the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/image/camera/lens.hpp"

namespace pivnp::image {

struct CameraOptions {
  std::optional<double> metres_per_pixel = {};
  std::optional<Pair> origin_px = {};
  Points points_px = {};
  Points points_m = {};
  std::string length_unit = "m";
  LensModel lens = LensModel::none;
  std::optional<Pair> focal_px = {};
  std::optional<Pair> centre_px = {};
  std::vector<double> distortion = {};
  double lens_rms_px = 0;
  double window_thickness_m = 0;
  std::optional<double> window_distance_m = {};
  double window_index = 1.49;
  double row_time_s = 0;
  double exposure_s = 0;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("metres_per_pixel", self.metres_per_pixel,
          OptionInfo{.unit = "m/px", .text = "scale of a square-on camera; default, without points: lengths are in px",
                     .min = 0, .above_min = true});
    visit("origin_px", self.origin_px,
          OptionInfo{.unit = "px",
                     .text = "pixel (column, row) of the world's (0, 0); default: the lower left pixel"});
    visit("points_px", self.points_px,
          OptionInfo{.unit = "px", .text = "four or more targets in the image, for a homography"});
    visit("points_m", self.points_m,
          OptionInfo{.unit = "m", .text = "the same targets in the world"});
    visit("length_unit", self.length_unit,
          OptionInfo{.text = "unit of the case's lengths: m, mm, cm, km or um; another name: a length of the scene"});
    visit("lens", self.lens,
          OptionInfo{.text = "distortion, as `pivnp calibrate` finds it: brown is radial and tangential"});
    visit("focal_px", self.focal_px, OptionInfo{.unit = "px", .text = "focal lengths along columns and rows, of a lens or a window"});
    visit("centre_px", self.centre_px,
          OptionInfo{.unit = "px", .text = "principal point (column, row); default: the middle of the image"});
    visit("distortion", self.distortion,
          OptionInfo{.text = "coefficients in OpenCV's order: k1 k2 p1 p2 k3 (brown), k1 k2 k3 k4 (fisheye)"});
    visit("lens_rms_px", self.lens_rms_px,
          OptionInfo{.unit = "px", .text = "RMS residual of the calibration", .min = 0});
    visit("window_thickness_m", self.window_thickness_m,
          OptionInfo{.unit = "m", .text = "thickness of the window before the material (0: no refraction)", .min = 0});
    visit("window_distance_m", self.window_distance_m,
          OptionInfo{.unit = "m", .text = "from the lens's entrance pupil to the window", .min = 0, .above_min = true});
    visit("window_index", self.window_index,
          OptionInfo{.text = "refractive index of the window (acrylic 1.49, glass 1.52)", .min = 1, .max = 3});
    visit("row_time_s", self.row_time_s,
          OptionInfo{.unit = "s", .text = "rolling shutter: read-out time over rows; negative: from the lowest row up (0: none)", .min = -0.01, .max = 0.01});
    visit("exposure_s", self.exposure_s,
          OptionInfo{.unit = "s", .text = "exposure time, to warn of motion blur (0: not known)", .min = 0});
  }
};

/// Plane-to-plane camera: world = dehomogenised(world_from_pixel * (c, r, 1)), where (c, r) is the ideal pixel that the
/// lens makes of (column, row) (lens.hpp; without one the same). World y is up, pixel centres lie on whole numbers. The third coordinate is positive on the visible side; a point at or beyond the horizon is NaN.
class Camera {
 public:
  Camera();  // pixels: world = (column, -row)
  /// Throws InputError if the matrix cannot be inverted.
  Camera(const Mat3& world_from_pixel, double residual, std::string length_unit, Lens lens = {});

  Vec2 to_world(const Vec2& pixel) const;
  Vec2 to_pixel(const Vec2& world) const;
  /// d world / d pixel at a pixel.
  Mat2 jacobian(const Vec2& pixel) const;
  const Mat3& world_from_pixel() const { return world_from_pixel_; }  // of ideal pixels
  /// RMS of the targets and of the lens's calibration, length unit; 0 for a plain scale.
  double residual() const { return residual_; }
  const std::string& length_unit() const { return length_unit_; }
  bool plain() const;  // a scale, a shift and the flip of y, without a lens's distortion
  const Lens& lens() const { return lens_; }
  /// The same camera after it has moved: what was at p is at `moved` p, ideal pixels, homogeneous.
  Camera after(const Mat3& moved) const;

 private:
  Mat3 world_from_pixel_, pixel_from_world_;
  double residual_ = 0;
  std::string length_unit_ = "px";
  Lens lens_;
};

/// Scale and origin, or a homography from targets (see homography.hpp), or pixels: world = (column - origin column,
/// origin row - row), unit "px" whatever length_unit says. Without an origin the world's (0, 0) is the centre of the
/// lower left pixel, (0, height - 1). A homography's residual is the RMS distance of the targets in the world.
/// With a lens, targets are freed of its distortion before; lens_rms_px is added to the residual (in squares).
/// Throws InputError: lists of different length, fewer than four points, points on a line, a target given twice, the
/// lists in different order, both ways given at once.
Camera make_camera(const CameraOptions& options, int width, int height);

}  // namespace pivnp::image

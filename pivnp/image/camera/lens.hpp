// What a lens, and a window in front of the material, make of a straight line.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::image {

enum class LensModel { none, brown, fisheye };
inline constexpr std::array lens_model_names{NamedValue{"none", LensModel::none}, NamedValue{"brown", LensModel::brown},
                                             NamedValue{"fisheye", LensModel::fisheye}};
constexpr const auto& names_of(LensModel) { return lens_model_names; }

/// A plane window that the camera looks through squarely; the material lies against its back.
struct Window {
  double thickness = 0;  // length; 0: none
  double distance = 1;   // from the lens's entrance pupil to the window's front, same unit
  double index = 1.49;   // refractive, of acrylic
};

/// Pixels of the image <-> ideal pixels, those of a camera without distortion or window that has the same focal lengths,
/// principal point and, on its axis, scale. With x the direction of the ray (tangents of its angles to the axis):
///   brown    Brown (1971) with the coefficients k1 k2 p1 p2 k3, in OpenCV's order; fewer: the rest is 0
///   fisheye  Kannala & Brandt (2006), k1 k2 k3 k4: angle t on the axis -> t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)
/// A window of thickness h, index n at the distance D moves what is seen at the angle t from r0 = (D + h/n) tan t to
/// D tan t + h tan t', sin t' = sin t / n (Snell).
/// NaN where the model folds over (beyond the angle at which the image's radius no longer grows), and from 89 degrees on.
class Lens {
 public:
  Lens() = default;
  /// Throws InputError: focal lengths not above 0, too many coefficients, an index below 1, an image beyond the fold.
  Lens(LensModel model, const Vec2& focal_px, const Vec2& centre_px, std::vector<double> coefficients, const Window& window);

  bool straight() const { return model_ == LensModel::none && window_.thickness == 0; }
  Vec2 to_ideal(const Vec2& pixel) const;
  Vec2 to_pixel(const Vec2& ideal) const;
  /// d ideal / d pixel.
  Mat2 jacobian(const Vec2& pixel) const;

  LensModel model() const { return model_; }
  const Vec2& focal() const { return focal_; }
  const Vec2& centre() const { return centre_; }
  const std::vector<double>& coefficients() const { return k_; }
  const Window& window() const { return window_; }

 private:
  Vec2 distorted(const Vec2& ray) const;    // brown
  double bent(double angle) const;          // fisheye: radius in the image over the focal length
  double ratio(double tangent) const;       // of the window: where it is seen over where it would be
  double fold() const;                      // greatest radius (brown) or angle (fisheye) of use

  LensModel model_ = LensModel::none;
  Vec2 focal_ = Vec2::Ones(), centre_ = Vec2::Zero();
  std::vector<double> k_;
  Window window_;
  double most_ = 0;
};

}  // namespace pivnp::image

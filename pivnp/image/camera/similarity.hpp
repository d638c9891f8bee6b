// The motion of a camera from points that are at rest.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/record/camera_motion.hpp"

namespace pivnp::image {

/// What a camera may do between two frames.
enum class MotionModel { shift, rigid, similarity };
inline constexpr std::array motion_model_names{NamedValue{"shift", MotionModel::shift},
                                               NamedValue{"rigid", MotionModel::rigid},
                                               NamedValue{"similarity", MotionModel::similarity}};
constexpr const auto& names_of(MotionModel) { return motion_model_names; }

/// Points that a model needs at least.
constexpr int least_points(MotionModel model) { return model == MotionModel::shift ? 1 : 2; }

struct RestPoint {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();  // px, first and later frame
  double variance = 0;                          // of a component of `to`, px^2; 0: all alike
};

struct RestFit {
  bool found = false;  // as many points as the model needs agree
  CameraPlace place;
  std::vector<std::uint8_t> agrees;  // one a point
};

/// The motion that most points share: of models through two points each (all pairs, or a fixed sample of 500) the one
/// with the least truncated sum of squares (MSAC, Torr & Zisserman 2000), then weighted least squares about `centre`
/// with Tukey's weights (c = 4.685, the scale from the median of the distances, at least `floor_px`). Points farther
/// than `tolerance_px` from the shared motion do not agree. Closed form in each iteration: the four parameters are
/// linear (Umeyama 1991 in the plane). Variances come from the residuals, or from the points' own where those are
/// greater.
RestFit fit_rest(std::span<const RestPoint> points, MotionModel model, const Vec2& centre, double tolerance_px,
                 double floor_px = 0.005);

}  // namespace pivnp::image

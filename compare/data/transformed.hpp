// A motion in other coordinates: shifted, turned, scaled, and on another clock.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

/// x' = scale R(angle) x + shift;  t' = time_scale t + time_offset.
struct Transform {
  double scale = 1, angle = 0;  // angle: radians, counter-clockwise
  Vec2 shift = Vec2::Zero();
  double time_scale = 1, time_offset = 0;

  bool identity() const {
    return scale == 1 && angle == 0 && shift == Vec2::Zero() && time_scale == 1 && time_offset == 0;
  }
};

/// Reads `motion`, which must outlive it, through a transform. Displacements, covariances, velocities and areas go with
/// the lengths and times, as other fields do by their unit and form; F and stress turn only.
class TransformedMotion final : public MotionSource {
 public:
  TransformedMotion(const MotionSource& motion, const Transform& transform);

  const std::string& name() const override { return motion_->name(); }
  const std::string& length_unit() const override { return motion_->length_unit(); }
  const std::string& time_unit() const override { return motion_->time_unit(); }
  const ParticleSet& particles() const override { return particles_; }
  const std::vector<double>& times() const override { return times_; }
  MotionFrame frame(std::size_t index) const override;

 private:
  const MotionSource* motion_;
  Transform transform_;
  Mat2 rotation_;
  ParticleSet particles_;
  std::vector<double> times_;
};

}  // namespace pivnp::compare

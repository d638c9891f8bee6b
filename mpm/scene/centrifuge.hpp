// The acceleration field of a centrifuge, in the frame of the model.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

/// How the rotation axis lies: across the plane of the simulation (it is normal to it), along it (parallel to x, above the
/// model), or it is the axis of symmetry of an axisymmetric run.
enum class RotationAxis { across, along, symmetry };
inline constexpr std::array rotation_axis_names{NamedValue{"across", RotationAxis::across}, NamedValue{"along", RotationAxis::along},
                                                NamedValue{"symmetry", RotationAxis::symmetry}};
constexpr const auto& names_of(RotationAxis) { return rotation_axis_names; }

struct CentrifugeOptions {
  RotationAxis axis = RotationAxis::across;
  std::optional<double> radius_m;
  Pair at_m = {0.0, 0.0};
  std::optional<double> rate_rpm;
  Points rate_history;
  std::optional<bool> coriolis;
  bool euler = false;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("axis", self.axis, OptionInfo{.text = "rotation axis radius_m above at_m, normal to the plane (across) or along x; symmetry: the axis of an axisymmetric run"});
    visit("radius_m", self.radius_m, OptionInfo{.unit = "m", .text = "from the rotation axis down to at_m", .min = 0, .above_min = true});
    visit("at_m", self.at_m, OptionInfo{.unit = "m", .text = "place (x, y) where radius_m is measured"});
    visit("rate_rpm", self.rate_rpm, OptionInfo{.unit = "1/min", .text = "rate of rotation, anticlockwise"});
    visit("rate_history", self.rate_history, OptionInfo{.unit = "s, 1/min", .text = "times and rates, in place of rate_rpm"});
    visit("coriolis", self.coriolis, OptionInfo{.text = "Coriolis acceleration; default: true for axis across, the only one that has it in the plane"});
    visit("euler", self.euler, OptionInfo{.text = "acceleration by a changing rate (across)"});
  }
};

/// Centrifugal, Coriolis and Euler accelerations, of a rate that changes linearly between given times. With d the vector from the
/// rotation axis and w the rate: w^2 d, in the plane; 2 w (v_y, -v_x); and dw/dt (d_y, -d_x).
class Centrifuge {
 public:
  /// Throws InputError naming centrifuge.<key>.
  Centrifuge(const CentrifugeOptions& options, bool axisymmetric);

  double rate(double time) const;  // rad/s
  /// Of what is at rest in the model's frame, m/s^2.
  Vec2 acceleration(const Vec2& x, double time) const;
  bool coriolis() const { return coriolis_; }
  /// Of what moves there.
  Vec2 coriolis(const Vec2& v, double time) const { return coriolis_ ? 2 * rate(time) * Vec2(v.y(), -v.x()) : Vec2(0, 0); }
  /// Velocity `n` at the end of a step in which it was `v` at the start, turned by the Coriolis acceleration of the mean of the
  /// two, which does no work.
  static Vec2 turned(const Vec2& v, const Vec2& n, double rate_dt);
  double greatest(const Vec2& x) const;  // centrifugal acceleration there, m/s^2
  /// Times at which the rate begins or ceases to change, ascending; none where it is constant.
  const std::vector<double>& changes() const { return changes_; }

 private:
  RotationAxis axis_;
  Vec2 centre_;
  std::vector<std::pair<double, double>> rates_;  // time, rad/s
  std::vector<double> changes_;
  bool coriolis_ = false, euler_ = false;
};

}  // namespace pivnp::mpm

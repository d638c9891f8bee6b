// The rigid motion that fits a set of points best, and how well it is known.
#pragma once

#include <limits>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// x = centre + R(angle) (X - centre) + shift.
struct RigidMotion {
  Vec2 centre = Vec2::Zero(), shift = Vec2::Zero();
  double angle = 0;  // radians, counter-clockwise

  Mat2 rotation() const;
  Vec2 apply(const Vec2& X) const { return centre + rotation() * (X - centre) + shift; }
  /// Where a point at x would be without this motion.
  Vec2 undo(const Vec2& x) const { return centre + rotation().transpose() * (x - centre - shift); }
};

/// Standard uncertainties, NaN where they cannot be estimated.
struct RigidFit {
  RigidMotion motion;  // centre: mean of X
  Vec2 sigma_shift = Vec2::Constant(std::numeric_limits<double>::quiet_NaN());
  double sigma_angle = std::numeric_limits<double>::quiet_NaN();

  /// Variance that the fit's own error gives the displacement of a point at X, x and y.
  Vec2 variance_at(const Vec2& X) const;
};

/// Least squares of |x - apply(X)| (Procrustes in the plane, closed form); without `turn` the mean displacement alone.
/// Uncertainty: jackknife that leaves out one of up to 4 x 4 blocks of the points' box at a time, so that errors shared
/// by neighbours count as what they are as long as they reach no further than a block; NaN with fewer than four blocks.
RigidFit fit_rigid(const std::vector<Vec2>& X, const std::vector<Vec2>& x, bool turn);

}  // namespace pivnp::compare

// How far material points moved, how they were strained, and the pressure of their water, against time.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::report {

/// |u| of one material point against time; NaN where it is not followed.
struct PointCurve {
  std::vector<double> time, displacement;
  std::vector<double> sigma;  // standard uncertainty of |u|; empty if the source knows none
  std::vector<double> pressure;  // of the pores, Pa; empty if the source knows none
  std::vector<double> strain;    // deviatoric, of F
  std::vector<double> strain_sigma;  // its standard uncertainty; empty if the source knows none
};

/// The particle at the point, or the affine fit through the six nearest in the material configuration; the covariance
/// is the nearest particle's. All NaN if no particle starts within two particle spacings of the point.
std::vector<PointCurve> point_curves(const MotionSource& motion, const std::vector<Vec2>& points);

}  // namespace pivnp::report

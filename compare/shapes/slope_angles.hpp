// The angle of a heap against a wall by three measures, from its mass alone.
#pragma once

#include "compare/shapes/slope.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::compare {

/// Angles in degrees; NaN where undefined.
struct SlopeAngles {
  double cen = 0;  // of the trapezoid with a vertical wall, of the same area and centroid: no threshold, no front grain
  double fit = 0;  // regression of the profile between 10 and 90 % of its height
  double tc = 0;   // from the toe (x within which 99.5 % of the area lies) to the crest (last column of 90 % of the height), by the
                   // profile's heights there
  double toe_x = 0;  // as above
  double height = 0;  // of the highest column
};

/// Heap between a wall at `wall_x` and its toe towards +x, on a base at `base_y`. The profile is area per column of
/// width `column`, each particle spread over `spread` (its own width) about its place; ended particles are left out.
SlopeAngles slope_angles(const ParticleSet& particles, const MotionFrame& frame, double wall_x, double base_y,
                         double column, double spread);

}  // namespace pivnp::compare

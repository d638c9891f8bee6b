// Fields on particles at chosen times.
#pragma once

#include <string>
#include <vector>

#include "apps/plot/raster.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::report {

/// One field at one time, ready to be coloured.
struct FieldAtTime {
  double time = 0;
  std::vector<Vec2> position, half_x, half_y;  // of the deformed squares
  std::vector<double> value;                   // NaN: not known
  std::vector<ParticleStatus> status;
};
/// At each time; empty vectors where the motion has no frame near it. Throws InputError for an unknown field.
std::vector<FieldAtTime> fields_at(const MotionSource& motion, const std::string& field, bool central,
                                      const std::vector<double>& times);

/// Box around the positions, but for the outermost `share` on each side, with a margin; never empty.
plot::Box box_around(const std::vector<const std::vector<Vec2>*>& positions, double share);

}  // namespace pivnp::report

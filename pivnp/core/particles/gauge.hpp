// Strain over another gauge length.
#pragma once

#include <memory>

#include "pivnp/core/particles/motion.hpp"

namespace pivnp {

/// The motion with F fitted to the displacements of the particles within `gauge` / 2 of each in the material (least
/// squares of a plane; those born at the same time and alive at the frame). NaN where fewer than three, or three in a
/// line, are left. All else is as in `motion`. Lengths in the motion's unit.
std::shared_ptr<const MotionSource> with_gauge(std::shared_ptr<const MotionSource> motion, double gauge);

}  // namespace pivnp

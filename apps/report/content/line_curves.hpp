// Virtual extensometers and cross-sections.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::report {

/// Strain of the line between two material points: its length over the first, less 1, against time. NaN where an end is
/// not followed. `sigma`: standard uncertainty, the ends' errors taken as independent; empty: not known.
struct ExtensometerCurve {
  std::vector<double> time, strain, sigma;
};
ExtensometerCurve extensometer(const MotionSource& motion, const Vec2& from, const Vec2& to);

/// A field along a line in space at the frame nearest to `time`: the value of the nearest particle within a spacing, NaN
/// where there is none. `distance` from the first end; `sigma`: standard uncertainty of a strain, where the motion states a
/// covariance of F; empty: not known.
struct SectionCurve {
  std::vector<double> distance, value, sigma;
};
SectionCurve section(const MotionSource& motion, const std::string& field, bool central, double time, const Vec2& from,
                     const Vec2& to);

}  // namespace pivnp::report

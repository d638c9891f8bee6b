// A motion read at places that are asked for: material points, a rectangle, the line between two points, a line in space.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp {

/// Edge of the square that a particle stands for; 0 where the source tells no area.
double particle_spacing(const ParticleSet& particles, std::size_t p);

/// A motion with one particle a point of the material at the first frame: every value is that of the particle there, or of the
/// affine fit through the six nearest (ended where one of them has ended); covariances are those of the nearest. Unborn
/// at all times where no particle starts within two spacings. A scalar that none of the six has below zero is not either.
std::shared_ptr<const MotionSource> at_points(std::shared_ptr<const MotionSource> motion, const std::vector<Vec2>& points);

/// A motion of one particle, the mean over the particles that start in a rectangle and are followed, weighted by area; its F is
/// that of a gauge as large as the rectangle. Unborn where there are none. Covariances: errors are one and the same within
/// cells of `correlation_length` (of a measurement: StrainNote::gauge_length), independent from cell to cell,
///   C = sum over cells (sum of w) (sum of w C_p),  sum of all w = 1;
/// 0: one and the same everywhere. `lower`, `upper`: corners, length unit.
std::shared_ptr<const MotionSource> in_rectangle(std::shared_ptr<const MotionSource> motion, const Vec2& lower, const Vec2& upper,
                                                 double correlation_length);

/// Strain of the line between two material points: its length over the first, less 1, against time. NaN where an end is
/// not followed. `sigma`: standard uncertainty, the ends' errors taken as independent; empty: not known.
struct ExtensometerCurve {
  std::vector<double> time, strain, sigma;
};
ExtensometerCurve extensometer(const MotionSource& motion, const Vec2& from, const Vec2& to);

/// A field along a line in space at a frame, at 121 places: the value of the nearest particle within a spacing, NaN where
/// there is none. `distance` from the first end; `sigma`: standard uncertainty, where the motion states one; empty: not known.
struct SectionCurve {
  std::vector<double> distance, value, sigma;
};
SectionCurve section(const MotionSource& motion, const std::string& field, bool central, std::size_t frame, const Vec2& from,
                     const Vec2& to);

}  // namespace pivnp

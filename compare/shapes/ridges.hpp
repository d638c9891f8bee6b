// Shear bands: ridge lines of deviatoric strain.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// One ridge line. Lengths in the motion's unit.
struct ShearBand {
  Vec2 centre = Vec2::Zero();
  double inclination_deg = 0;  // of the line of least squares through the ridge, from x, (-90, 90]
  double length = 0;           // along that line
  double thickness = 0;  // width at half height of the strain across the ridge, median along it; NaN if not reached
  double strain = 0;           // greatest deviatoric strain of the ridge
  double peak = 0;             // median deviatoric strain of the ridge
  double slip = 0;  // displacement across it: sqrt(3) times the integral of the strain across the ridge, out to a tenth of its
                    // height or to where it rises again, median along it (simple shear g has the deviatoric strain g/sqrt(3))
  double onset = 0;            // time at which half of the particles along it had reached the threshold
  double rate = 0;             // strain per time there and then, median of those particles; NaN: none of them has one
  std::vector<Vec2> ridge;
  /// At each of its places: of these all above but `strain` is made. NaN: not known there; onset infinite: never.
  struct Place {
    double width = 0, strain = 0, slip = 0, onset = 0, rate = 0;
  };
  std::vector<Place> places;

  /// The part of it that lies between `from` and `to` along `direction` from `origin`; its greatest strain is the whole's.
  ShearBand between(const Vec2& origin, const Vec2& direction, double from, double to) const;
};

/// A scalar on scattered particles, `spacing` their distance.
struct ScatteredField {
  std::vector<Vec2> x;
  std::vector<double> value, spacing;
  std::vector<double> onset;  // per particle, NaN: never
  std::vector<double> rate;   // of its strain at its onset
};

/// Ridges by the second derivatives of the field smoothed with a Gaussian of one spacing, on a lattice of half a
/// spacing: where the slope across the direction of greatest negative curvature vanishes within the cell (Steger 1998,
/// IEEE Trans. Pattern Anal. Mach. Intell. 20), the field is at least `threshold` there, and the curvature would bring
/// it down by a tenth within two spacings. Neighbouring cells whose directions agree within 37 degrees are one band,
/// from a length of four spacings on. Strongest (length times strain) first.
std::vector<ShearBand> find_bands(const ScatteredField& field, double median_spacing, double threshold);

}  // namespace pivnp::compare

// What is read off a slope's profile: run-out, crest, angle.
#pragma once

#include <vector>

#include "compare/shapes/outline.hpp"

namespace pivnp::compare {

/// Share of the area that lies within the run-out, and below the crest.
inline constexpr double run_out_share = 0.995;

/// Heap of material on a base. Lengths in the lattice's unit.
struct SlopeShape {
  int faces = 0;           // +1: it descends towards +x, -1: towards -x (the wider descent; +1 if both are as wide)
  double run_out_x = 0;    // x within which 99.5 % of the area lies, on that side
  double crest_height = 0;  // above the base, below which 99.5 % of the area lies
  double angle_deg = 0;    // of the fitted line, 0 to 90; NaN with fewer than four columns between 10 and 90 %
  double angle_uncertainty_deg = 0;
  double face_length = 0;  // of the columns that the line is fitted to, along it
  double thin_from = 0;    // x beyond which the thin end lies: 2 % of the area
  double thinness = 0;     // cot of the angle of the thin end, as a wedge by the places of 98 and 99.5 % of the area
};

/// Area above the base, column by column, divided by the column's width.
struct Profile {
  double first_x = 0, width = 1;  // of the columns' centres
  std::vector<double> height;

  double x(std::size_t k) const { return first_x + width * double(k); }
};
Profile profile_above(const Cover& cover, double base_y);

/// `spacing`: of the particles; so many columns of the profile are one independent value in the angle's uncertainty.
/// Everything NaN and faces 0 if there is no area above the base.
SlopeShape slope_shape(const Cover& cover, double base_y, double spacing);

/// The angle and its side alone, for a given height of the crest.
void fit_slope(const Profile& profile, double crest_height, double spacing, SlopeShape& shape);

}  // namespace pivnp::compare

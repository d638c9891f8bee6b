// Strength of a soil as its history and its stress leave it.
//
// Softening (the thesis' 4.13, 4.14): c and phi fall from peak to residual as exp(-eta k), k the accumulated plastic
// deviatoric strain (a sum along the path: strength does not come back on reversal). Dilatancy fades alike,
// psi = psi0 exp(-k/fade), and never exceeds phi.
// Friction that depends on stress: phi = phi_high + (phi_low - phi_high)/(1 + p/p_half), p the mean pressure: phi_low
// without confinement, half-way at p_half. (The thesis' 3.2: 43 degrees below 2 kPa, 30 in a shear box at 50-200 kPa;
// curved envelopes after Bolton 1986, Geotechnique 36:65. The rational form keeps the surface convex.)
// Regularisation: material softens in a band as wide as the cells h let it be. With a length L the rate becomes
// eta h/L: a slip of k h does what it would do in a band of width L, whatever h (smeared; Pietruszczak & Mroz 1981,
// Int. J. Numer. Meth. Engng 17:327; Bazant & Oh 1983). Or k is averaged around the point (nonlocal.hpp), which sets the
// band's width itself; the rate is eta then.
#pragma once

#include "mpm/material/lanes.hpp"
#include "mpm/material/model.hpp"

namespace pivnp::mpm {

/// Strength at a point and instant; angles in radians, Pa.
struct Strength {
  double friction, sin_friction, cos_friction;
  double cohesion;
  double sin_dilatancy;
  double friction_by_history, friction_by_pressure;  // derivatives
  double cohesion_by_history;
};

/// What soils with a cone share: friction, dilatancy, cohesion and tension, the rules between them, and what they remember.
std::vector<MaterialKey> cone_keys();
std::vector<HistoryVariable> cone_history();
void check_cone(const MaterialOptions& options);
/// Cohesion, tension and the tangents of all angles of friction; the dilatancy stays below the friction.
void reduce_cone(MaterialOptions& options, double factor);
/// The same for soils whose strength changes.
std::vector<MaterialKey> soil_keys();
void check_soil(const MaterialOptions& options);

class StrengthLaw {
 public:
  /// Of constants that check_soil() accepts. `cell_m`: side of the cells, for the regularised rate of softening. Throws
  /// MaterialFault.
  StrengthLaw(const MaterialOptions& options, double cell_m);

  /// `history`: accumulated plastic deviatoric strain; `pressure`: mean Cauchy pressure, compression positive, Pa (below
  /// zero it counts as zero).
  Strength at(double history, double pressure) const {
    return constant_ ? initial_ : changed(history, pressure);
  }
  bool constant() const { return constant_; }
  bool by_pressure() const { return per_half_ > 0; }
  StrengthConstants constants() const {
    return {friction_, friction_low_, per_half_, residual_friction_, cohesion_, residual_cohesion_, rate_,
            dilatancy_, per_fade_};
  }
  /// Before any history, without pressure.
  const Strength& initial() const { return initial_; }
  double peak_sin_dilatancy() const { return sin_dilatancy_; }
  double residual_friction() const { return residual_friction_; }
  double nonlocal_length() const { return nonlocal_length_; }

 private:
  Strength changed(double history, double pressure) const;

  double friction_, friction_low_, per_half_, residual_friction_;
  double cohesion_, residual_cohesion_;
  double rate_;  // of softening, for these cells
  double nonlocal_length_ = 0;
  double dilatancy_, per_fade_, sin_dilatancy_;
  bool constant_;
  Strength initial_{};
};

}  // namespace pivnp::mpm

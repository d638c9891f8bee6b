// Mohr-Coulomb, perfectly plastic, closed-form return in principal stresses.
//
// Sources: Clausen, Damkilde & Andersen 2006 (Int. J. Numer. Meth. Engng 66:1795) and de Souza Neto, Peric & Owen 2008,
// chapter 8: the surface is six planes, so a return to a plane, an edge (two planes) or the apex is one small linear
// system. Planes, principal stresses s1 >= s2 >= s3, tension positive:
//   f_ij = (1 + sin phi) s_i - (1 - sin phi) s_j - 2 c cos phi,   flow by the same form with the dilatancy psi;
//   t_i  = s_i - tension   (Rankine's cut-off, associated), used where the tension limit lies below the apex.
// A state that satisfies the planes with non-negative multipliers is the one wanted (Koiter). Beside the cut-off each
// of the few that can be is in closed form.
//
// Opening: material whose two stresses in the plane are returned to the limit under expansion has separated. Its
// stress is zero, and the expansion is kept as opening strain; compression first closes it, and only what is left over
// loads the material again. So it flies free and lands with the volume it left with. Once separated, tension stays
// zero.
#pragma once

#include <array>

#include "mpm/material/lanes.hpp"
#include "mpm/material/model.hpp"
#include "mpm/material/strength.hpp"

namespace pivnp::mpm {

MaterialModel mohr_coulomb_model();
MaterialModel tresca_model();

class MohrCoulomb final : public Material {
 public:
  /// Angles in degrees, 0 <= dilatancy <= friction < 90; cohesion and tension in Pa.
  MohrCoulomb(const Elastic& elastic, double friction_deg, double dilatancy_deg, double cohesion_pa,
              double tension_pa);
  /// For update_point() alone: with the strength of a point.
  MohrCoulomb(const Elastic& elastic, const Strength& strength, double tension_pa)
      : Material(elastic),
        sin_friction_(strength.sin_friction),
        cos_friction_(strength.cos_friction),
        sin_dilatancy_(strength.sin_dilatancy),
        cohesion_(strength.cohesion),
        tension_(tension_pa),
        cone_{} {}
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
  /// Updates a point that is open before and after the step; else false, nothing done.
  static bool stays_open(const Elastic& elastic, const StressBatch& batch, std::size_t k);
  /// One point, in scalar code.
  void update_point(const StressBatch& batch, std::size_t k) const;
  /// Largest of the yield functions f_13 and t_1 (Pa) at a stress; negative inside.
  double yield(double xx, double yy, double zz, double xy) const;

 private:
  using Principal = std::array<double, 3>;
  struct Plane {
    Principal normal, flow, d_flow;  // gradient of f, plastic flow, elastic stiffness times flow
    double limit;                    // f = normal . s - limit
  };
  struct Return {
    Principal stress;
    double limit;  // greatest tension: the cut-off's or the apex'
  };
  Plane shear_plane(int i, int j, double cohesion_term) const;
  Return return_to_surface(const Principal& trial, double J, double tension) const;
  Return return_to_cone(const Principal& trial, double cohesion_term, double apex) const;
  Return return_with_cut_off(const Principal& trial, double cohesion_term, double tension) const;
  void return_point(const StressBatch& batch, std::size_t k, Stress trial) const;

  ConeConstants constants() const;

  double sin_friction_, cos_friction_, sin_dilatancy_, cohesion_, tension_;
  ConeConstants cone_;
};

/// The same with a strength that changes (strength.hpp): every point is returned with the strength of its history and
/// pressure before the step. Explicit: the strength lags by one step, which is of the order of the step's plastic strain
/// times the rate of softening.
class VariableMohrCoulomb final : public Material {
 public:
  VariableMohrCoulomb(const Elastic& elastic, const StrengthLaw& strength, double tension_pa)
      : Material(elastic), strength_(strength), tension_(tension_pa) {}
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
  double nonlocal_length() const override { return strength_.nonlocal_length(); }

 private:
  StrengthLaw strength_;
  double tension_;
};

}  // namespace pivnp::mpm

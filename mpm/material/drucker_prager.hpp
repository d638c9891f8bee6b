// Drucker-Prager, and the mu(I) rheology on the same cone.
//
// drucker_prager: sqrt(J2) + alpha s_m <= k, flow with beta in alpha's place (Drucker & Prager 1952); the cone that has
// Mohr-Coulomb's strength in plane strain at failure: with ez' = 0 there, alpha = sin phi/D, k = c cos phi/D,
// D = sqrt(1 - beta^2/3) + beta sin phi/3, beta = 3 tan psi/sqrt(9 + 12 tan^2 psi). (With psi = phi the familiar
// 3 tan phi/sqrt(9 + 12 tan^2 phi).)
// mu_i: Jop, Forterre & Pouliquen 2006 (Nature 441:727): sqrt(J2) <= mu(I) p, mu = mu_s + (mu_2 - mu_s)/(1 + I0/I),
// I = g d sqrt(rho_s/p), g = sqrt(2 e':e') the plastic shear rate; no volume change. mu_s = sin of friction_deg and mu_2
// of friction_flow_deg (plane strain as above). The implicit return is the quadratic of Dunatunga & Kamrin 2015 (J.
// Fluid Mech. 779:483). Without a step's length (initial equilibrium) the friction is mu_s.
// Both: mean stress at most min(tension, apex); beyond, the material stands open without stress (as in mohr_coulomb.hpp).
#pragma once

#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel drucker_prager_model();
MaterialModel mu_i_model();

class DruckerPrager final : public Material {
 public:
  struct Flow {
    double friction_deg = 0;  // in rapid flow; 0: no dependence on rate
    double inertial_number = 0, diameter_m = 0, grain_density = 0;
  };
  DruckerPrager(const Elastic& elastic, double friction_deg, double dilatancy_deg, double cohesion_pa,
                double tension_pa, const Flow& flow);
  void update(const StressBatch& batch) const override;

 private:
  void return_point(const StressBatch& batch, std::size_t k, const Stress& trial) const;
  double flowing_bar(double trial_bar, double pressure, double J, double dt) const;

  double alpha_, beta_, k_, tension_, bulk_;
  double alpha_flow_ = 0, inertial_number_ = 0, per_diameter_ = 0, grain_density_ = 0;
};

}  // namespace pivnp::mpm

// Modified Cam-Clay (Roscoe & Burland 1968), with p and q of the effective Cauchy stress, p positive in compression,
// v = 1 + e the specific volume, e_v volumetric strain positive in compression:
//   elastic    dp = v p/kappa de_v,  G = 3 (1 - 2 nu)/(2 (1 + nu)) v p/kappa
//   yield      f = (q/M)^2 + p (p - p_c) = 0, associated flow in p and q, radial in the deviatoric plane
//   hardening  dp_c = v p_c/(lambda - kappa) de_v^p
//   M          6 sin(phi)/(3 - sin(phi)) in compression; over Lode's angle by van Eekelen's form of Sheng et al. (2000):
//              M (2 a/(1 + a - (1 - a) s))^(1/4), a = ((3 - sin(phi))/(3 + sin(phi)))^4, s = 1 in compression, -1 in extension
// Implicit return (Borja & Lee 1990), exact in p and p_c, which are exponentials of the strains: with the plastic volumetric
// strain x of a step as the only unknown, q/M falls with x, and f has a root between x = 0 and the critical state.
//
// p_c is set by the first step after the initial equilibrium, in which the soil has the stiffness of
// p = preconsolidation_pa up to q = M p, or up to the yield surface of that p_c: p_c = max(preconsolidation_pa, ocr (p + q^2/(M^2 p))).
#pragma once

#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel modified_cam_clay_model();

class ModifiedCamClay final : public Material {
 public:
  struct Constants {
    double lambda, kappa, poisson, friction_deg, void_ratio, ocr, preconsolidation_pa;
  };
  explicit ModifiedCamClay(const Constants& constants);
  void update(const StressBatch& batch) const override;
  double energy(const StressBatch& batch, std::size_t k) const override;
  double stiffness(const StressBatch& batch) const override;

 private:
  void find_start(const StressBatch& batch, std::size_t k) const;
  void update_point(const StressBatch& batch, std::size_t k) const;
  /// Per initial volume, of a Kirchhoff stress.
  double stored(const Stress& tau, double J) const;
  double slope(double sin3) const;
  double most_at_start(double p) const;

  Constants c_;
  double specific_volume_, shear_per_bulk_, slope_, third_, tension_, least_p_;
};

}  // namespace pivnp::mpm

// The generalised vortex: a motion that is prescribed, and the body force that makes it a solution.
#pragma once

#include <array>

#include "mpm/scene/scene.hpp"

namespace pivnp::mpm {

/// A ring, 0.75 to 1.25 m, nu 0.3, rho 1050 kg/m3, neo-Hookean, turned by alpha = amplitude sin(pi t) h(s), h = 1 - 8 s^2 + 16 s^4,
/// s = (r - 1)/(Ri - Ro) (Kamojjala et al. 2015, Eng. Comput. 31:209). With r = R and J = 1: tau_rt = mu R alpha', tau_tt = mu (R alpha')^2,
/// so (derived here, not copied)
///   b_r = mu/rho R alpha'^2 - R alpha_t^2,   b_t = R alpha_tt - mu/rho (3 alpha' + R alpha'').
/// The discrete ring's net torque of the elastic part is taken out: it is zero, and would turn the free ring.
class GeneralisedVortex {
 public:
  /// `amplitude` in rad at the turning point, t = 0.5 s; `young` in Pa.
  GeneralisedVortex(double amplitude, double young) : amplitude_(amplitude), young_(young) {}

  /// Rings of points, `across` to a cell's side.
  Scene scene(double cell, double across = 2) const;
  /// At the turning point, of the point that started at X: where it is, and its Cauchy stress xx yy xy.
  Vec2 position(const Vec2& X) const;
  std::array<double, 3> stress(const Vec2& X) const;

 private:
  double shear_modulus() const { return young_ / 2.6; }
  double amplitude_, young_;
};

}  // namespace pivnp::mpm

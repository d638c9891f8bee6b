// The smooth Mohr-Coulomb surface of Abbo & Sloan.
//
// Sources: Abbo & Sloan 1995 (Comput. Struct. 54:427), hyperbola in the meridian; Abbo, Lyamin, Sloan & Hambleton 2011
// (Int. J. Solids Struct. 48:3001), deviatoric section with continuous second derivatives. Tension positive:
//   F = s_m sin phi + sqrt(sbar^2 K(theta)^2 + a^2 sin^2 phi) - t sin phi,
// s_m mean stress, sbar = sqrt(J2), sin 3 theta = -(3 sqrt 3/2) J3/sbar^3; K = cos theta - sin theta sin phi/sqrt 3 up to
// |theta| = 25 degrees, beyond A + B sin 3 theta + C sin^2 3 theta with the same value, slope and curvature there.
// t sin phi = max(c cos phi, floor sin phi): the apex of the cone lies at least `floor` (Pa) from zero stress, so that
// the surface is smooth for c = 0 too; a = 0.05 t, Abbo & Sloan's. The vertex is at s_m = 0.95 t. Inside the cone and
// at its vertex, for theta between -25 and 25 degrees far from the vertex, F is Mohr-Coulomb's; at 30 degrees the
// rounding takes up to 3 % of sbar.
#pragma once

#include <array>

#include "mpm/material/strength.hpp"

namespace pivnp::mpm {

/// xx, yy, zz, xy.
using Tensor = std::array<double, 4>;

inline double product(const Tensor& a, const Tensor& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2 * a[3] * b[3];
}

/// What the surface needs of a stress.
struct Invariants {
  double mean, bar;   // mean stress; sqrt(J2)
  double sin3;        // sin 3 theta; 0 where bar is
  Tensor deviator;

  explicit Invariants(const Tensor& stress);
};

class AbboSloan {
 public:
  explicit AbboSloan(double floor_pa);

  /// F, Pa. `scale`: of the strength's stresses (J: strengths bound the Cauchy stress, stresses are Kirchhoff's).
  double value(const Invariants& at, const Strength& s, double scale) const;
  /// dF/d stress by tensor components: dF = g : d stress. The friction's dependence on pressure is in it.
  Tensor gradient(const Invariants& at, const Strength& s, double scale) const;
  /// dF/d k, k the plastic strain that softens.
  double by_history(const Invariants& at, const Strength& s, double scale) const;
  /// Flow: the gradient of the same form with the dilatancy, with the hyperbola of the friction.
  Tensor flow(const Invariants& at, const Strength& s, double scale) const;
  /// sbar of the surface at a mean stress and Lode angle; 0 beyond the vertex.
  double bar_on_surface(double mean, double sin3, const Strength& s, double scale) const;
  /// 0.9 t: greatest mean stress that laws should allow, just short of the vertex, where the flow still has a direction;
  /// infinite without friction.
  double greatest_mean(const Strength& s, double scale) const;

 private:
  struct Section {
    double K, K_by_3;  // K and dK/d theta over cos 3 theta
    double K_by_sin;   // dK/d sin phi
  };
  Section section(double sin3, double sin_phi) const;
  Tensor deviatoric(const Invariants& at, const Section& k, double root) const;
  double by_friction(const Invariants& at, const Strength& s, double scale) const;
  double intercept(const Strength& s, double scale) const;  // t sin phi

  double floor_;
  // A, B, C of either end: [end][0] without, [end][1] times sin phi.
  double a_[2][2], b_[2][2], c_[2][2];
};

}  // namespace pivnp::mpm

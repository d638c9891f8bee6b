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
//
// No angle is ever formed: the principal deviators are 2 sbar/sqrt 3 sin(theta + 0, +-120 degrees), so sin theta is
// sqrt 3/2 of the middle one over sbar, and in plane strain they are known in closed form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

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
  double sine;        // sin theta; 0 where bar is
  Tensor deviator;

  explicit Invariants(const Tensor& stress);
};

class AbboSloan {
  // K = a + b sin phi, dK/d theta over cos 3 theta = a3 + b3 sin phi.
  struct Section {
    double a, b, a3, b3;
  };

 public:
  explicit AbboSloan(double floor_pa);
  double floor_pa() const { return floor_; }

  /// The surface at a stress, with what its derivatives share.
  struct Place {
    double F;  // Pa
    Invariants at;
    Strength strength;
    double scale;  // of the strength's stresses (J: strengths bound the Cauchy stress, stresses are Kirchhoff's)
    double sin3;   // sin 3 theta
    Section section;
    double intercept;    // t sin phi
    double reach, root;  // sbar K; the hyperbola's root
  };
  Place place(const Invariants& at, const Strength& s, double scale) const;

  /// dF/d stress by tensor components: dF = g : d stress. The friction's dependence on pressure is in it.
  Tensor gradient(const Place& p) const;
  /// dF/d k, k the plastic strain that softens.
  double by_history(const Place& p) const;
  /// Flow: the gradient of the same form with the dilatancy, with the hyperbola of the friction.
  Tensor flow(const Place& p) const;
  /// sbar of the surface at that mean stress and Lode angle; 0 beyond the vertex.
  double bar_on_surface(const Place& p) const;
  /// 0.9 t: greatest mean stress that laws should allow, just short of the vertex, where the flow still has a direction;
  /// infinite without friction.
  static double greatest_mean(const Place& p);
  /// The surface's part of a law's constants.
  void put_constants(SmoothConstants& out) const;

 private:
  Section section(double sine, double sin3) const;
  Tensor deviatoric(const Place& p, double sin_angle, double reach, double root) const;
  double by_friction(const Place& p) const;
  bool cohesive(const Strength& s) const { return s.cohesion * s.cos_friction >= floor_ * s.sin_friction; }

  static constexpr double hyperbola = 0.05;       // a over t
  static constexpr double short_of_vertex = 0.9;  // over t
  static constexpr double root3 = std::numbers::sqrt3;
  static constexpr double sin3_transition = 0.96592582628906829;  // 75 degrees

  double floor_;
  // A, B, C of either end: [end][0] without, [end][1] times sin phi.
  double a_[2][2], b_[2][2], c_[2][2];
};

inline Invariants::Invariants(const Tensor& s) : mean((s[0] + s[1] + s[2]) / 3), deviator{s[0] - mean, s[1] - mean, s[2] - mean, s[3]} {
  const Tensor& d = deviator;
  const double half = 0.5 * (d[0] - d[1]), radius2 = half * half + d[3] * d[3];
  bar = std::sqrt(radius2 + 0.75 * d[2] * d[2]);
  // The middle one of the principal deviators -d_zz/2 +- radius and d_zz.
  const double radius = std::sqrt(radius2), middle = std::max(std::min(d[2], radius - 0.5 * d[2]), -radius - 0.5 * d[2]);
  sine = bar > 0 ? std::clamp(0.5 * std::numbers::sqrt3 * (middle / bar), -0.5, 0.5) : 0.0;
}

inline AbboSloan::Section AbboSloan::section(double sine, double sin3) const {
  if (std::abs(sin3) <= sin3_transition) {
    const double cosine = std::sqrt(1 - sine * sine);
    const double per = 1 / (cosine * (1 - 4 * sine * sine));  // 1 / cos 3 theta
    return {cosine, -sine / root3, -sine * per, -cosine * per / root3};
  }
  const int end = sin3 > 0;
  const auto value = [&](int part) { return a_[end][part] + sin3 * (b_[end][part] + sin3 * c_[end][part]); };
  const auto slope = [&](int part) { return 3 * (b_[end][part] + 2 * c_[end][part] * sin3); };
  return {value(0), value(1), slope(0), slope(1)};
}

inline AbboSloan::Place AbboSloan::place(const Invariants& at, const Strength& s, double scale) const {
  const double sin3 = at.sine * (3 - 4 * at.sine * at.sine);
  const Section k = section(at.sine, sin3);
  const double t = scale * std::max(s.cohesion * s.cos_friction, floor_ * s.sin_friction);
  const double reach = at.bar * (k.a + k.b * s.sin_friction);
  const double root = std::sqrt(reach * reach + hyperbola * hyperbola * t * t);
  return {at.mean * s.sin_friction + root - t, at, s, scale, sin3, k, t, reach, root};
}

inline double AbboSloan::greatest_mean(const Place& p) {
  return p.strength.sin_friction > 0 ? short_of_vertex * p.intercept / p.strength.sin_friction
                                     : std::numeric_limits<double>::infinity();
}

// The root's gradient: d(bar K) = (K - K' tan 3 theta) d bar - (sqrt 3 K'/(2 cos 3 theta bar^2)) d J3, times bar K/root.
inline Tensor AbboSloan::deviatoric(const Place& p, double sin_angle, double reach, double root) const {
  Tensor g{0, 0, 0, 0};
  const Invariants& at = p.at;
  if (!(at.bar > 0)) return g;
  const Tensor& d = at.deviator;
  const double per_bar = 1 / at.bar, K_by_3 = p.section.a3 + p.section.b3 * sin_angle;
  const double factor = reach * per_bar / root, K = reach * per_bar;
  const double straight = factor * 0.5 * (K - K_by_3 * p.sin3), bent = factor * -0.5 * root3 * K_by_3 * per_bar;
  const double third = 2.0 / 3 * at.bar * at.bar;
  const Tensor squared{d[0] * d[0] + d[3] * d[3] - third, d[1] * d[1] + d[3] * d[3] - third, d[2] * d[2] - third,
                       d[3] * (d[0] + d[1])};
  for (std::size_t q = 0; q < 4; ++q) g[q] = straight * d[q] + bent * squared[q];
  return g;
}

inline Tensor AbboSloan::gradient(const Place& p) const {
  const Strength& s = p.strength;
  Tensor g = deviatoric(p, s.sin_friction, p.reach, p.root);
  double mean = s.sin_friction / 3;
  if (s.friction_by_pressure != 0) mean -= by_friction(p) * s.friction_by_pressure / (3 * p.scale);
  for (std::size_t q = 0; q < 3; ++q) g[q] += mean;
  return g;
}

inline Tensor AbboSloan::flow(const Place& p) const {
  const double sin_angle = p.strength.sin_dilatancy, t = p.intercept;
  const double reach = p.at.bar * (p.section.a + p.section.b * sin_angle);
  Tensor g = deviatoric(p, sin_angle, reach, std::sqrt(reach * reach + hyperbola * hyperbola * t * t));
  for (std::size_t q = 0; q < 3; ++q) g[q] += sin_angle / 3;
  return g;
}

}  // namespace pivnp::mpm

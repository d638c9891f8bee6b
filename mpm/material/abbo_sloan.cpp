#include "mpm/material/abbo_sloan.hpp"

#include <cmath>
#include <numbers>

namespace pivnp::mpm {

namespace {

constexpr double transition = 25 * std::numbers::pi / 180;

}  // namespace

AbboSloan::AbboSloan(double floor_pa) : floor_(floor_pa) {
  for (int end = 0; end < 2; ++end) {
    const double theta = end == 0 ? -transition : transition;
    const double s3 = std::sin(3 * theta), c3 = std::cos(3 * theta);
    for (int part = 0; part < 2; ++part) {
      // cos theta and -sin theta / sqrt 3, with their derivatives.
      const double k = part == 0 ? std::cos(theta) : -std::sin(theta) / root3;
      const double k1 = part == 0 ? -std::sin(theta) : -std::cos(theta) / root3, k2 = -k;
      c_[end][part] = (k2 + 3 * s3 * k1 / c3) / (18 * c3 * c3);
      b_[end][part] = k1 / (3 * c3) - 2 * c_[end][part] * s3;
      a_[end][part] = k - b_[end][part] * s3 - c_[end][part] * s3 * s3;
    }
  }
}

void AbboSloan::put_constants(SmoothConstants& out) const {
  out.floor = floor_;
  for (int end = 0; end < 2; ++end)
    for (int part = 0; part < 2; ++part) {
      out.a[end][part] = a_[end][part];
      out.b[end][part] = b_[end][part];
      out.c[end][part] = c_[end][part];
    }
  out.sin3_transition = sin3_transition;
  out.hyperbola = hyperbola;
  out.short_of_vertex = short_of_vertex;
}

double AbboSloan::by_friction(const Place& p) const {
  const Strength& s = p.strength;
  const double dt = p.scale * (cohesive(s) ? -s.cohesion * s.sin_friction : floor_ * s.cos_friction);
  const double K_by_angle = p.section.b * s.cos_friction;
  const double d_root = (p.at.bar * p.reach * K_by_angle + hyperbola * hyperbola * p.intercept * dt) / p.root;
  return p.at.mean * s.cos_friction + d_root - dt;
}

double AbboSloan::by_history(const Place& p) const {
  const Strength& s = p.strength;
  double d = s.friction_by_history != 0 ? by_friction(p) * s.friction_by_history : 0;
  if (s.cohesion_by_history != 0 && cohesive(s))
    d += p.scale * s.cos_friction * s.cohesion_by_history * (hyperbola * hyperbola * p.intercept / p.root - 1);
  return d;
}

double AbboSloan::bar_on_surface(const Place& p) const {
  const double t = p.intercept, root = t - p.at.mean * p.strength.sin_friction;
  const double squared = root * root - hyperbola * hyperbola * t * t;
  return root > 0 && squared > 0 ? std::sqrt(squared) / (p.section.a + p.section.b * p.strength.sin_friction) : 0;
}

}  // namespace pivnp::mpm

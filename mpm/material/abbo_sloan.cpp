#include "mpm/material/abbo_sloan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pivnp::mpm {

namespace {

constexpr double transition = 25 * std::numbers::pi / 180;
constexpr double hyperbola = 0.05;  // a over t
const double sin3_transition = std::sin(3 * transition);
constexpr double short_of_vertex = 0.9;  // over t
constexpr double root3 = std::numbers::sqrt3;

}  // namespace

Invariants::Invariants(const Tensor& s) : mean((s[0] + s[1] + s[2]) / 3), deviator{s[0] - mean, s[1] - mean, s[2] - mean, s[3]} {
  const Tensor& d = deviator;
  bar = std::sqrt(0.5 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + d[3] * d[3]);
  const double j3 = d[2] * (d[0] * d[1] - d[3] * d[3]);
  sin3 = bar > 0 ? std::clamp(-1.5 * root3 * (j3 / bar) / (bar * bar), -1.0, 1.0) : 0.0;
  if (!(sin3 == sin3)) sin3 = 0;  // bar so small that its square is zero
}

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

AbboSloan::Section AbboSloan::section(double sin3, double sin_phi) const {
  if (std::abs(sin3) <= sin3_transition) {
    const double theta = std::asin(sin3) / 3, s = std::sin(theta), c = std::cos(theta);
    const double slope = -s - sin_phi * c / root3;
    return {c - sin_phi * s / root3, slope / std::sqrt(1 - sin3 * sin3), -s / root3};
  }
  const int end = sin3 > 0;
  const double a = a_[end][0] + sin_phi * a_[end][1], b = b_[end][0] + sin_phi * b_[end][1];
  const double c = c_[end][0] + sin_phi * c_[end][1];
  return {a + sin3 * (b + sin3 * c), 3 * (b + 2 * c * sin3), a_[end][1] + sin3 * (b_[end][1] + sin3 * c_[end][1])};
}

double AbboSloan::intercept(const Strength& s, double scale) const {
  return scale * std::max(s.cohesion * s.cos_friction, floor_ * s.sin_friction);
}

double AbboSloan::greatest_mean(const Strength& s, double scale) const {
  return s.sin_friction > 0 ? short_of_vertex * intercept(s, scale) / s.sin_friction
                            : std::numeric_limits<double>::infinity();
}

double AbboSloan::value(const Invariants& at, const Strength& s, double scale) const {
  const double t = intercept(s, scale), reach = at.bar * section(at.sin3, s.sin_friction).K;
  return at.mean * s.sin_friction + std::sqrt(reach * reach + hyperbola * hyperbola * t * t) - t;
}

// The root's gradient: d(bar K) = (K - K' tan 3 theta) d bar - (sqrt 3 K'/(2 cos 3 theta bar^2)) d J3, times bar K/root.
Tensor AbboSloan::deviatoric(const Invariants& at, const Section& k, double root) const {
  Tensor g{0, 0, 0, 0};
  if (!(at.bar > 0)) return g;
  const Tensor& d = at.deviator;
  const double straight = 0.5 * (k.K - k.K_by_3 * at.sin3), bent = -0.5 * root3 * k.K_by_3 / at.bar;
  const double third = 2.0 / 3 * at.bar * at.bar, factor = k.K / root;
  const Tensor squared{d[0] * d[0] + d[3] * d[3] - third, d[1] * d[1] + d[3] * d[3] - third, d[2] * d[2] - third,
                       d[3] * (d[0] + d[1])};
  for (std::size_t q = 0; q < 4; ++q) g[q] = factor * (straight * d[q] + bent * squared[q]);
  return g;
}

double AbboSloan::by_friction(const Invariants& at, const Strength& s, double scale) const {
  const Section k = section(at.sin3, s.sin_friction);
  const double t = intercept(s, scale), reach = at.bar * k.K;
  const double root = std::sqrt(reach * reach + hyperbola * hyperbola * t * t);
  const bool cohesive = s.cohesion * s.cos_friction >= floor_ * s.sin_friction;
  const double dt = scale * (cohesive ? -s.cohesion * s.sin_friction : floor_ * s.cos_friction);
  const double d_root = (at.bar * reach * k.K_by_sin * s.cos_friction + hyperbola * hyperbola * t * dt) / root;
  return at.mean * s.cos_friction + d_root - dt;
}

Tensor AbboSloan::gradient(const Invariants& at, const Strength& s, double scale) const {
  const Section k = section(at.sin3, s.sin_friction);
  const double t = intercept(s, scale), reach = at.bar * k.K;
  Tensor g = deviatoric(at, k, std::sqrt(reach * reach + hyperbola * hyperbola * t * t));
  double mean = s.sin_friction / 3;
  if (s.friction_by_pressure != 0) mean -= by_friction(at, s, scale) * s.friction_by_pressure / (3 * scale);
  for (std::size_t q = 0; q < 3; ++q) g[q] += mean;
  return g;
}

Tensor AbboSloan::flow(const Invariants& at, const Strength& s, double scale) const {
  const Section k = section(at.sin3, s.sin_dilatancy);
  const double t = intercept(s, scale), reach = at.bar * k.K;
  Tensor g = deviatoric(at, k, std::sqrt(reach * reach + hyperbola * hyperbola * t * t));
  for (std::size_t q = 0; q < 3; ++q) g[q] += s.sin_dilatancy / 3;
  return g;
}

double AbboSloan::by_history(const Invariants& at, const Strength& s, double scale) const {
  double d = s.friction_by_history != 0 ? by_friction(at, s, scale) * s.friction_by_history : 0;
  if (s.cohesion_by_history != 0 && s.cohesion * s.cos_friction >= floor_ * s.sin_friction) {
    const double t = intercept(s, scale), reach = at.bar * section(at.sin3, s.sin_friction).K;
    const double root = std::sqrt(reach * reach + hyperbola * hyperbola * t * t);
    d += scale * s.cos_friction * s.cohesion_by_history * (hyperbola * hyperbola * t / root - 1);
  }
  return d;
}

double AbboSloan::bar_on_surface(double mean, double sin3, const Strength& s, double scale) const {
  const double t = intercept(s, scale), root = t - mean * s.sin_friction;
  const double squared = root * root - hyperbola * hyperbola * t * t;
  return root > 0 && squared > 0 ? std::sqrt(squared) / section(sin3, s.sin_friction).K : 0;
}

}  // namespace pivnp::mpm

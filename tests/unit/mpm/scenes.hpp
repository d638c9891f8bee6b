// Small scenes for the solver's tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

namespace pivnp::mpm::test {

inline MaterialOptions elastic(double young, double poisson, double density) {
  MaterialOptions m;
  m.model = "linear_elastic";
  m.young_pa = young;
  m.poisson = poisson;
  m.density_kg_m3 = density;
  return m;
}

inline MaterialOptions sand(double friction_deg, double young = 5e6) {
  MaterialOptions m = elastic(young, 0.3, 1600);
  m.model = "mohr_coulomb";
  m.friction_deg = friction_deg;
  return m;
}

inline Region rectangle(const std::string& name, double x0, double y0, double x1, double y1) {
  return {name, Polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, name)};
}

inline Region disc(const std::string& name, Vec2 centre, double radius) {
  std::vector<Vec2> ring;
  for (int k = 0; k < 360; ++k) {
    const double a = 2 * M_PI * k / 360;
    ring.push_back(centre + radius * Vec2(std::cos(a), std::sin(a)));
  }
  return {name, Polygon(ring, name)};
}

inline Scene scene(const Grid& grid, const std::vector<Region>& regions, const std::vector<MaterialOptions>& materials,
                   int per_element = 4) {
  Scene s;
  s.grid = grid;
  s.particles = seed(grid, regions, per_element, SeedPattern::even, 0, "per_element");
  s.materials = materials;
  return s;
}

inline BoundaryOptions line(Pair a, Pair b, const std::string& type, double friction = 0) {
  BoundaryOptions o;
  o.line_m = {a, b};
  o.type = *value_named<BoundaryType>(type);
  o.friction = friction;
  return o;
}

inline MpmOptions options(Pair gravity = {0, 0}) {
  MpmOptions o;
  o.gravity_m_s2 = gravity;
  return o;
}

/// The thesis' bilinear scheme: pure FLIP.
inline MpmOptions conservative(Pair gravity = {0, 0}) {
  MpmOptions o = options(gravity);
  o.scheme = SchemeName::geopart;
  return o;
}

/// A column 0.1 wide and `height` high on a fixed base between rollers, 10 mm cells.
inline Scene column(double height, const MaterialOptions& material) {
  const int up = int(std::lround(height / 0.01));
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, up + 5}, {rectangle("soil", 0, 0, 0.1, height)}, {material});
  s.boundaries = {{"base", line({0, 0}, {0.1, 0}, "fixed")},
                  {"left", line({0, 0}, {0, height + 0.04}, "roller")},
                  {"right", line({0.1, 0}, {0.1, height + 0.04}, "roller")}};
  return s;
}

/// Mean of a stress component (0 xx, 1 yy) over the particles with y below `under` at the start.
inline double mean_stress(const Solver& solver, std::size_t component, double under, double over = -1) {
  const MotionFrame frame = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    const double y = solver.particles().x0[k].y();
    if (y > under || y < over || frame.status[k] == ParticleStatus::ended) continue;
    sum += double(frame.field("stress")(k, component));
    ++n;
  }
  return sum / n;
}

/// Takes the particles off that lie within a circle.
inline void keep_outside(ParticleSet& set, const Vec2& centre, double radius) {
  ParticleSet out;
  out.label_names = set.label_names;
  for (std::size_t k = 0; k < set.size(); ++k) {
    if ((set.x0[k] - centre).norm() <= radius) continue;
    out.id.push_back(set.id[k]);
    out.label.push_back(set.label[k]);
    out.x0.push_back(set.x0[k]);
    out.area.push_back(set.area[k]);
    out.born.push_back(set.born[k]);
    out.end.push_back(set.end[k]);
    out.end_reason.push_back(set.end_reason[k]);
  }
  set = out;
}

/// Of displacement, m.
inline double greatest_difference(const MotionFrame& a, const MotionFrame& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.u.size(); ++k)
    most = std::max(most, std::hypot(double(a.u[k][0] - b.u[k][0]), double(a.u[k][1] - b.u[k][1])));
  return most;
}

}  // namespace pivnp::mpm::test

// Specimens of cohesive, softening soil in which a shear band forms, on cells of side h.
#pragma once

#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

/// Strength 50 to 20 kPa, e^-1 of the way down after a plastic deviatoric strain of 1/eta.
inline MaterialOptions softening_soil(double eta) {
  MaterialOptions m = sand(0, 1e7);
  m.density_kg_m3 = 2000;
  m.cohesion_pa = 5e4;
  m.tension_pa = 1e9;
  m.cohesion_residual_pa = 2e4;
  m.softening_shape = eta;
  return m;
}

inline MpmOptions shear_options() {
  MpmOptions o = options();
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  return o;
}

/// A layer of 80 x 80 mm between rough plates, the upper one moving at 0.1 m/s, vertical motion held (simple shear);
/// strength in the middle row of cells 2 % less.
inline Scene sheared_layer(double h, const MaterialOptions& soil) {
  const double side = 0.08, margin = 0.016, speed = 0.1;
  const int n = int(std::lround(side / h)), m = int(std::lround(margin / h));
  MaterialOptions weak = soil;
  weak.cohesion_pa *= 0.98;
  Scene s = scene(Grid{{0, 0}, {h, h}, n + 2 * m + 1, n + 1},
                  {rectangle("soil", margin, 0, margin + side, side)}, {soil, weak});
  s.particles.label_names.push_back("weak");
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.v0.push_back(Vec2(speed * s.particles.x0[k].y() / side, 0));
    if (std::abs(s.particles.x0[k].y() - side / 2 - h / 2) < h / 2) s.particles.label[k] = 1;
  }
  BoundaryOptions level, top = line({0, side}, {side + 2 * margin, side}, "fixed");
  level.polygon_m = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  level.type = BoundaryType::roller;
  level.normal = Pair{0, 1};
  top.velocity_m_s = Pair{speed, 0};
  s.boundaries = {{"level", level}, {"base", line({0, 0}, {side + 2 * margin, 0}, "fixed")}, {"top", top}};
  return s;
}

/// A specimen 80 mm wide and 160 mm high, compressed by a smooth platen at 0.2 m/s on a smooth base; sides free. From a
/// block of 8 mm at its left side that is 10 % weaker a band rises at 45 degrees to the other side.
inline Scene compressed_specimen(double h, const MaterialOptions& soil) {
  const double left = 0.04, right = 0.12, high = 0.16, a = 0.04, b = 0.048;
  MaterialOptions weak = soil;
  weak.cohesion_pa *= 0.9;
  const Region whole{"soil", Polygon({{left, 0}, {right, 0}, {right, high}, {left, high}, {left, b}, {b, b}, {b, a}, {left, a}},
                                     "soil")};
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(0.16 / h)) + 1, int(std::lround(0.192 / h)) + 1},
                  {whole, rectangle("weak", left, a, b, b)}, {soil, weak});
  s.boundaries = {{"base", line({0, 0}, {0.16, 0}, "roller")}};
  RigidOptions platen;
  platen.polygon_m = {{0.02, high}, {0.14, high}, {0.14, high + 0.02}, {0.02, high + 0.02}};
  platen.velocity_m_s = {0, -0.2};
  platen.friction = 0;
  s.bodies = {{"platen", platen}};
  return s;
}

}  // namespace pivnp::mpm::test

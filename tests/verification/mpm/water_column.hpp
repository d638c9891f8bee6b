// A saturated column drained at its top, and Terzaghi's solution of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

struct WaterColumn {
  double young = 8e6, poisson = 0.2, porosity = 0.3, permeability = 1e-3, height = 1;
  double bulk = 2.2e9;
  int cells = 10;
  double load = 1e3;      // on the top, Pa
  double gravity = 0;     // downwards
  ShapeKind shape = ShapeKind::bspline;
  TransferKind transfer = TransferKind::apic;
  StressUpdate stress = StressUpdate::usl;
  Locking locking = Locking::fbar;
  PressureScheme pressure = PressureScheme::in_steps;
  double courant = 0.8;
  double damping = 0.3;
  double rise = 2e-3;     // of the load, in T
  double grains = 2650;

  double modulus() const { return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson)); }
  double storage() const { return 1 / modulus() + porosity / bulk; }
  double consolidation() const { return permeability / (1000 * 9.81 * storage()); }
  double undrained_share() const { return 1 / modulus() / storage(); }
  double density() const { return (1 - porosity) * grains + porosity * 1000; }
  /// Time at a time factor T.
  double at(double T) const { return T * height * height / consolidation(); }
  double spacing() const { return height / cells; }
};

inline MaterialOptions saturated(double young, double poisson, double porosity, double permeability, double grains = 2650) {
  MaterialOptions m;
  m.model = "linear_elastic";
  m.young_pa = young;
  m.poisson = poisson;
  m.porosity = porosity;
  m.permeability_m_s = permeability;
  m.grain_density_kg_m3 = grains;
  return m;
}

inline Scene scene_of(const WaterColumn& c) {
  const double h = c.spacing(), width = 2 * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, 3, c.cells + 3}, {rectangle("soil", 0, 0, width, c.height)},
                  {saturated(c.young, c.poisson, c.porosity, c.permeability, c.grains)});
  s.water.emplace();
  s.water->bulk_modulus_pa = c.bulk;
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "roller")},
                  {"left", line({0, 0}, {0, c.height + 2 * h}, "roller")},
                  {"right", line({width, 0}, {width, c.height + 2 * h}, "roller")}};
  if (c.load > 0) {
    BoundaryOptions top = line({0, c.height}, {width, c.height}, "traction");
    top.traction_pa = {0, -c.load};
    top.rise_s = c.at(c.rise);
    top.drained = true;
    s.boundaries.emplace_back("load", top);
  }
  return s;
}

inline MpmOptions options_of(const WaterColumn& c) {
  MpmOptions o = options({0, -c.gravity});
  o.shape = c.shape;
  o.transfer = c.transfer;
  o.stress_update = c.stress;
  o.locking = c.locking;
  o.pressure = c.pressure;
  o.courant = c.courant;
  o.damping = c.damping;
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.energy_limit = 1e9;
  return o;
}

/// Excess pressure after a load at once, at a depth, over that at the start.
inline double terzaghi(double depth_over_height, double T) {
  double sum = 0;
  for (int m = 1; m < 400; m += 2)
    sum += 4 / (m * M_PI) * std::sin(m * M_PI * depth_over_height / 2) * std::exp(-std::pow(m * M_PI / 2, 2) * T);
  return sum;
}
/// Degree of consolidation.
inline double terzaghi_settlement(double T) {
  double sum = 0;
  for (int m = 1; m < 400; m += 2) sum += 8 / std::pow(m * M_PI, 2) * std::exp(-std::pow(m * M_PI / 2, 2) * T);
  return 1 - sum;
}
/// Excess pressure that starts as a triangle, 1 at the base.
inline double terzaghi_triangle(double depth_over_height, double T) {
  double sum = 0;
  for (int m = 1; m < 400; m += 2)
    sum += 8 * ((m / 2) % 2 ? -1 : 1) / std::pow(m * M_PI, 2) * std::sin(m * M_PI * depth_over_height / 2) *
           std::exp(-std::pow(m * M_PI / 2, 2) * T);
  return sum;
}

}  // namespace pivnp::mpm::test

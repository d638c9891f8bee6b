// A saturated column drained at its top, Terzaghi's solution of it, and a saturated block of random velocities.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm::test {

inline constexpr PressureScheme schemes[] = {PressureScheme::in_steps, PressureScheme::projected};

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
  bool about_axis = false;
  int across = 2;         // cells

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
  const double h = c.spacing(), width = c.across * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, c.across + 1, c.cells + 3}, {rectangle("soil", 0, 0, width, c.height)},
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
  if (c.about_axis) o.geometry = Geometry::axisymmetric;
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

/// A block of 6 by 6 cells with random velocities, undamped.
struct RandomBlock {
  ShapeKind shape = ShapeKind::bspline;
  TransferKind transfer = TransferKind::apic;
  PressureScheme pressure = PressureScheme::in_steps;
  double young = 1e7, permeability = 1e-5, spacing = 0.05, bulk = 1e9;
  double spread = 1;  // 1: the points are at quarters of the cells; towards 2: on nodes
  bool lid = true;    // a closed box; or open above
  double lift = 0;    // off its base, in cells: then it is held at its sides alone
  bool inertia = false;  // of the water
  bool about_axis = false;  // its left side is the axis
};

// A column with cells of 10 mm, its water soft enough for few steps.
inline WaterColumn small_column() {
  WaterColumn c;
  c.young = 1e7;
  c.bulk = 3e8;
  c.permeability = 1e-5;
  c.height = 0.06;
  c.cells = 6;
  return c;
}

/// Forty steps on one and on three threads, and forty more after a restart on two.
inline void expect_same_bits(const MpmOptions& options, const Scene& s) {
  Solver one(options, s, 1), two(options, s, 3), again(options, s, 2);
  const double time = 40 * one.stable_step();
  one.advance_to(time, silent);
  two.advance_to(time, silent);
  EXPECT_TRUE(one.save() == two.save());
  again.load(one.save());
  one.advance_to(2 * time, silent);
  again.advance_to(2 * time, silent);
  EXPECT_TRUE(one.save() == again.save());
}

/// Has the energy grown after 500 steps?
inline bool grows_in(const RandomBlock& b, double courant) {
  const double h = b.spacing, high = (6 + std::ceil(b.lift)) * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, 7, b.lid ? 7 : 9 + int(std::ceil(b.lift))}, {rectangle("soil", 0, 0, 6 * h, 6 * h)},
                  {saturated(b.young, 0.2, 0.3, b.permeability)});
  s.water.emplace();
  s.water->bulk_modulus_pa = b.bulk;
  s.water->inertia = b.inertia;
  s.boundaries = {{"base", line({0, 0}, {6 * h, 0}, "roller")},
                  {"left", line({0, 0}, {0, high}, "roller")},
                  {"right", line({6 * h, 0}, {6 * h, high}, "roller")}};
  if (b.lid) s.boundaries.insert(s.boundaries.begin() + 1, {"top", line({0, 6 * h}, {6 * h, 6 * h}, "roller")});
  for (Vec2& x : s.particles.x0) {
    const Vec2 cell = (x / h).array().floor() + 0.5;
    x = h * (cell + b.spread * (x / h - cell));
    x.y() += b.lift * h;
  }
  std::uint32_t random = 12345;
  const auto next = [&] {
    random = random * 1664525u + 1013904223u;
    return 2e-6 * h * (double(random >> 8) / double(1 << 24) - 0.5);
  };
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    const double x = next();
    s.v0.emplace_back(x, next());
  }
  MpmOptions o = options();
  if (b.about_axis) o.geometry = Geometry::axisymmetric;
  o.shape = b.shape;
  o.transfer = b.transfer;
  o.courant = courant;
  o.pressure = b.pressure;
  o.end_at_rest = false;
  o.initial_equilibrium = false;
  o.energy_limit = 1e300;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  try {
    solver.advance_to(500 * solver.stable_step(), silent);
    const EnergyRow e = solver.energy();
    return !(e.kinetic + e.elastic + e.water < start.kinetic);
  } catch (const RunError&) {
    return true;
  }
}

}  // namespace pivnp::mpm::test

// Water in the pores: what momentum does on it is what it gains, beside boundaries and in light nodes too.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct Books {
  double gained = 0;  // over what was turned over until then, at most
  EnergyRow last;
};

Books run(const MpmOptions& o, const Scene& s, double until, int looks) {
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  double turned_over = 0;
  Books b;
  for (int k = 1; k <= looks; ++k) {
    solver.advance_to(until * k / looks, silent);
    b.last = solver.energy();
    turned_over = std::max(turned_over, start.kinetic + start.elastic + start.water + std::abs(b.last.external) + b.last.plastic + b.last.darcy + std::abs(b.last.damping));
    b.gained = std::max(b.gained, b.last.residual / turned_over);
  }
  return b;
}

Scene wet_block(double h, int across, int up, const MaterialOptions& soil, double level) {
  Scene s = scene(Grid{{0, 0}, {h, h}, across + 1, up + 5}, {rectangle("soil", 0, 0, across * h, up * h)}, {soil});
  s.water.emplace();
  s.water->level_m = level;
  s.boundaries = {{"left", line({0, 0}, {0, (up + 4) * h}, "roller")}, {"right", line({across * h, 0}, {across * h, (up + 4) * h}, "roller")}};
  return s;
}

// Water is pressed into clay from below and has reached less than a cell of it: where pressure changes so fast, strain that gives no
// pressure must take no work from it. (Forces of the points' own pressures gained 26 times what flow dissipates.)
TEST(PoreEnergy, ALayerThinnerThanACellGivesNothing) {
  const double h = 0.02;
  for (const ShapeKind shape : {ShapeKind::gimp, ShapeKind::bspline}) {
    Scene s = wet_block(h, 3, 8, saturated(1.8e6, 0.33, 0.45, 6e-7), 0.2);
    s.water->bulk_modulus_pa = 2e7;
    s.boundaries.push_back({"base", line({0, 0}, {3 * h, 0}, "roller")});
    s.boundaries.back().second.flux_m_s = 1e-4;
    MpmOptions o = options({0, -9.81});
    o.shape = shape;
    o.transfer = TransferKind::flip;
    o.locking = Locking::fbar;
    o.initial_equilibrium = false;
    o.k0 = 0.5;
    o.pressure = PressureScheme::in_steps;
    const Books b = run(o, s, 0.02, 1);
    EXPECT_GT(b.last.darcy, 0) << name_of(shape);
    EXPECT_LT(std::abs(b.last.residual), b.last.darcy) << name_of(shape);
  }
}

// A block falls into the next cells. As its points pass between linear functions they have nodes with next to no mass, which stiff
// water would drive ever faster.
TEST(PoreEnergy, LightNodesOfLinearFunctionsGiveNothing) {
  const double h = 0.02;
  MaterialOptions soil = saturated(1.6e6, 0.23, 0.45, 2e-7);
  Scene s = scene(Grid{{0, 0}, {h, h}, 9, 12}, {rectangle("lower", 0, 2 * h, 6 * h, 5 * h), rectangle("upper", 0, 5 * h, 6 * h, 9 * h)}, {soil, soil});
  s.water.emplace();
  s.water->level_m = 0.3;
  s.water->bulk_modulus_pa = 2.3e6;
  s.boundaries = {{"left", line({0, 0}, {0, 11 * h}, "roller")}};
  ContactOptions contact;
  contact.regions = {"upper"};
  contact.against = {"lower"};
  contact.friction = 0.0;
  s.contacts.emplace_back("bodies", contact);
  MpmOptions o = options({0, -9.81});
  o.shape = ShapeKind::bilinear;
  o.transfer = TransferKind::apic;
  o.stress_update = StressUpdate::usl;
  o.locking = Locking::selective;
  o.initial_equilibrium = false;
  o.pressure = PressureScheme::in_steps;
  o.energy_limit = 1e9;
  const Books b = run(o, s, 0.08, 40);
  EXPECT_LT(b.gained, 0.005);
}

}  // namespace
}  // namespace pivnp::mpm

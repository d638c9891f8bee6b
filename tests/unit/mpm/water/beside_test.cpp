// Water in the pores beside what else a scene may hold: contact, rigid bodies, tied sides, excavation, softening, gates, and walls
// that let waves out.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

double lost(const EnergyRow& now, const EnergyRow& start) {
  return std::abs(now.water_mass - start.water_mass - now.water_inflow) / start.water_mass;
}

WaterColumn short_column() {
  WaterColumn c;
  c.young = 1e7;
  c.bulk = 3e8;
  c.permeability = 1e-5;
  c.height = 0.08;
  c.cells = 8;
  return c;
}

// Two halves of a column, one on the other, drained at the top: the contact carries the whole load and lets no water through.
TEST(WaterBeside, AContactCarriesTheLoadAndHoldsTheWaterBack) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    WaterColumn c = short_column();
    c.shape = shape;
    c.damping = 0;  // (Cundall's shakes what touches.)
    Scene s = scene_of(c);
    const MaterialOptions soil = s.materials[0];
    const double h = c.spacing();
    const Scene halves = scene(s.grid, {rectangle("below", 0, 0, 2 * h, 0.5 * c.height), rectangle("above", 0, 0.5 * c.height, 2 * h, c.height)}, {soil, soil});
    s.particles = halves.particles;
    s.materials = halves.materials;
    ContactOptions contact;
    contact.regions = {"above"};
    s.contacts.emplace_back("middle", contact);
    Solver one(options_of(c), s, 1), two(options_of(c), s, 2);
    const EnergyRow start = one.energy();
    one.advance_to(c.at(0.01), silent);
    two.advance_to(c.at(0.01), silent);
    EXPECT_TRUE(one.save() == two.save());
    one.advance_to(c.at(0.4), silent);  // T 1.6 for the upper half
    const MotionFrame f = one.frame();
    double mean[2] = {0, 0};
    for (std::size_t k = 0; k < f.u.size(); ++k) mean[s.particles.label[k]] += 2 * double(f.field("pressure")(k, 0)) / c.load / double(f.u.size());
    EXPECT_NEAR(mean[0], c.undrained_share(), 0.03);
    EXPECT_NEAR(mean[1], 0, 0.06);
    EXPECT_LT(lost(one.energy(), start), 1e-12);
    EXPECT_LT(std::abs(one.energy().residual), 0.05 * one.energy().external);
  }
}

// A rigid piston on a column: no water leaves below it.
TEST(WaterBeside, ARigidBodyHoldsTheWaterBack) {
  WaterColumn c = short_column();
  c.load = 0;
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    c.shape = shape;
    Scene s = scene_of(c);
    const double h = c.spacing(), speed = 1e-5 * c.height / c.at(0.05);
    RigidOptions piston;
    piston.polygon_m = {{-h, c.height}, {3 * h, c.height}, {3 * h, c.height + 1.5 * h}, {-h, c.height + 1.5 * h}};
    piston.velocity_m_s = {0, -speed};
    piston.friction = 0;
    s.bodies.emplace_back("piston", piston);
    Solver solver(options_of(c), s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(c.at(0.05), silent);
    const EnergyRow end = solver.energy();
    EXPECT_LT(lost(end, start), 1e-12);
    EXPECT_NEAR(end.water_inflow, 0, 1e-15);
    const MotionFrame f = solver.frame();
    double mean = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) mean += double(f.field("pressure")(k, 0)) / double(f.u.size());
    EXPECT_NEAR(mean, c.bulk / c.porosity * 1e-5, 0.01 * c.bulk / c.porosity * 1e-5);
  }
}

// An endless slope of which a piece between tied sides is seen: water flows along it, and the pressure grows with the depth.
TEST(WaterBeside, SeepageAlongAnEndlessSlope) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    const double h = 0.01, height = 0.06, width = 0.03, angle = 0.3, g = 9.81, permeability = 1e-5;
    Scene s = scene(Grid{{0, 0}, {h, h}, 4, 9}, {rectangle("soil", 0, 0, width, height)}, {saturated(1e7, 0.2, 0.3, permeability)});
    s.water.emplace();
    s.water->bulk_modulus_pa = 3e7;
    BoundaryOptions sides = line({0, 0}, {0, 0.08}, "tied");
    sides.across_m = Pair{width, 0};
    s.boundaries = {{"base", line({0, 0}, {width, 0}, "fixed")}, {"sides", sides}};
    MpmOptions o = options({g * std::sin(angle), -g * std::cos(angle)});
    o.shape = shape;
    if (shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
    o.damping = 0.1;  // (More of Cundall's shakes what is tied.)
    o.energy_limit = 1e9;
    o.initial_equilibrium = false;
    o.end_at_rest = false;
    Solver solver(o, s, 1), again(o, s, 2);
    const EnergyRow start = solver.energy();
    const double storage = 0.7 / 0.9 * 1.2 * 0.6 / 0.7 / 1e7 + 0.3 / 3e7, end = 3 * height * height * 9810 * storage / permeability;
    solver.advance_to(0.8 * end, silent);
    const EnergyRow middle = solver.energy();
    again.load(solver.save());
    solver.advance_to(end, silent);
    again.advance_to(end, silent);
    EXPECT_TRUE(solver.save() == again.save());
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      EXPECT_NEAR(double(f.field("pressure")(k, 0)), 9810 * std::cos(angle) * (height - s.particles.x0[k].y()), 12) << s.particles.x0[k];
      EXPECT_NEAR(double(f.field("water_flow")(k, 0)), permeability * std::sin(angle), 0.02 * permeability);
      EXPECT_NEAR(double(f.field("water_flow")(k, 1)), 0, 0.02 * permeability);
    }
    const EnergyRow last = solver.energy();
    EXPECT_LT(lost(last, start), 1e-12);
    const double rate = permeability / 9810 * std::pow(9810 * std::sin(angle), 2) * width * height;
    EXPECT_NEAR((last.darcy - middle.darcy) / (0.2 * end), rate, 0.03 * rate);
    EXPECT_NEAR((last.external - middle.external) / (0.2 * end), rate, 0.04 * rate);
  }
}

TEST(WaterBeside, ATiedSideHasNoConditionOfItsOwn) {
  const WaterColumn c = short_column();
  Scene s = scene_of(c);
  BoundaryOptions sides = line({0, 0}, {0, 0.08}, "tied");
  sides.across_m = Pair{2 * c.spacing(), 0};
  sides.drained = true;
  s.boundaries = {{"base", line({0, 0}, {2 * c.spacing(), 0}, "fixed")}, {"sides", sides}};
  EXPECT_THROW(Solver(options_of(c), s, 1), InputError);
}

// What is dug out takes its water along; where it was, the rest drains.
TEST(WaterBeside, ExcavationOpensTheSoilBelow) {
  WaterColumn c = short_column();
  c.load = 0;
  c.gravity = 9.81;
  Scene s = scene_of(c);
  const double h = c.spacing();
  MaterialOptions dug = s.materials[0];
  dug.removed_s = c.at(0.5);
  const Scene halves = scene(s.grid, {rectangle("below", 0, 0, 2 * h, 0.5 * c.height), rectangle("dug", 0, 0.5 * c.height, 2 * h, c.height)}, {s.materials[0], dug});
  s.particles = halves.particles;
  s.materials = halves.materials;
  s.water->level_m = c.height;
  MpmOptions o = options_of(c);
  o.initial_equilibrium = true;
  o.equilibrium_tolerance = 1e-3;  // (at perfect rest each of 33,000 steps rounds alike, 5e-17 of the water)
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  const EnergyRow start = solver.energy();
  solver.advance_to(c.at(0.51), silent);
  EXPECT_NEAR(solver.energy().water_mass, 0.5 * start.water_mass, 1e-3 * start.water_mass);
  EXPECT_LT(lost(solver.energy(), start), 1e-12);
  EXPECT_EQ(solver.ended(), s.particles.size() / 2);
}

// A bank with a core that softens falls when its gate is drawn: no water and no energy from nothing.
TEST(WaterBeside, ABankThatSoftensBehindAGateThatIsDrawn) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    MaterialOptions soil = saturated(2e6, 0.3, 0.4, 1e-5);
    soil.model = "mohr_coulomb";
    soil.friction_deg = 30;
    soil.cohesion_pa = 300;
    soil.cohesion_residual_pa = 0;
    soil.softening_shape = 10;
    Scene s = scene(Grid{{0, 0}, {0.02, 0.02}, 31, 14}, {rectangle("soil", 0, 0, 0.2, 0.2)}, {soil});
    s.water.emplace();
    s.water->bulk_modulus_pa = 2e7;
    BoundaryOptions gate = line({0.2, 0}, {0.2, 0.24}, "roller");
    gate.withdraw_m_s = Pair{0, 4};
    s.boundaries = {{"base", line({0, 0}, {0.6, 0}, "fixed")}, {"left", line({0, 0}, {0, 0.24}, "roller")}, {"gate", gate}};
    MpmOptions o = options({0, -9.81});
    o.shape = shape;
    if (shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
    o.initial_equilibrium = false;
    o.end_at_rest = false;
    o.energy_limit = 1;
    Solver solver(o, s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(0.25, silent);
    const EnergyRow end = solver.energy();
    const MotionFrame f = solver.frame();
    double farthest = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) farthest = std::max(farthest, double(f.u[k][0]));
    EXPECT_GT(farthest, 0.02);
    EXPECT_LT(lost(end, start), 1e-12);
    EXPECT_LT(end.residual, 0.01 * end.external);  // none from nothing
  }
}

// The fast wave of the undrained mixture leaves through an absorbing wall.
TEST(WaterBeside, AnAbsorbingWallLetsTheUndrainedWaveOut) {
  WaterColumn c = short_column();
  c.load = 0;
  c.cells = 60;
  c.height = 1.2;
  c.permeability = 1e-9;
  c.damping = 0;
  Scene s = scene_of(c);
  s.boundaries.emplace_back("top", line({0, c.height}, {2 * c.spacing(), c.height}, "absorbing"));
  const double fast = std::sqrt((c.modulus() + c.bulk / c.porosity) / c.density());
  for (const Vec2& x : s.particles.x0) s.v0.emplace_back(0, 1e-4 * std::exp(-std::pow((x.y() - 0.6) / 0.12, 2)));
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  solver.advance_to(2.6 * c.height / fast, silent);
  const EnergyRow end = solver.energy();
  EXPECT_LT(end.kinetic + end.elastic + end.water, 4e-3 * start.kinetic);
}

}  // namespace
}  // namespace pivnp::mpm

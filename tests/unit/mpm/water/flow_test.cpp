// Water in the pores: what flows where, and what is conserved.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <tuple>
#include <utility>

#include "mpm/material/model.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr PressureScheme schemes[] = {PressureScheme::in_steps, PressureScheme::projected};

double lost_mass(const EnergyRow& now, const EnergyRow& start) {
  return (now.water_mass - start.water_mass - now.water_inflow) / start.water_mass;
}

TEST(PoreWater, ACompressedBoxSharesTheLoadByStiffness) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    WaterColumn c = small_column();
    c.shape = shape;
    c.load = 0;
    Scene s = scene_of(c);
    BoundaryOptions top = line({0, c.height}, {2 * c.spacing(), c.height}, "fixed");
    const double time = c.at(0.05), strain = 1e-6;
    top.velocity_m_s = Pair{0, -strain * c.height / time};
    s.boundaries.emplace_back("top", top);
    Solver solver(options_of(c), s, 1);
    solver.advance_to(time, silent);
    const MotionFrame f = solver.frame();
    const double pressure = c.bulk / c.porosity * strain, stress = -c.modulus() * strain;
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      EXPECT_NEAR(double(f.field("pressure")(k, 0)), pressure, 0.005 * pressure);
      EXPECT_NEAR(double(f.field("stress")(k, 1)), stress, 0.05 * -stress);
      EXPECT_NEAR(double(f.field("porosity")(k, 0)), 0.3 - 0.7 * strain, 1e-7);
    }
    EXPECT_NEAR(solver.energy().water_inflow, 0, 1e-15);
  }
}

class PoreWaterBy : public testing::TestWithParam<PressureScheme> {};
INSTANTIATE_TEST_SUITE_P(Schemes, PoreWaterBy, testing::ValuesIn(schemes), [](const auto& row) { return std::string(name_of(row.param)); });

TEST_P(PoreWaterBy, SteadyFlowBetweenTwoPressures) {
  WaterColumn c = small_column();
  c.pressure = GetParam();
  c.load = 0;
  Scene s = scene_of(c);
  const double width = 2 * c.spacing(), below = 5e3, above = 1e3;
  const double flow = c.permeability * (below - above) / (1000 * 9.81 * c.height);
  s.boundaries[0].second.pressure_pa = below;
  BoundaryOptions top = line({0, c.height}, {width, c.height}, "roller");
  top.pressure_pa = above;
  s.boundaries.emplace_back("top", top);
  Solver solver(options_of(c), s, 1);
  const EnergyRow start = solver.energy();
  solver.advance_to(c.at(0.8), silent);
  const MotionFrame f = solver.frame();
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double y = s.particles.x0[k].y();
    EXPECT_NEAR(double(f.field("pressure")(k, 0)), below + (above - below) * y / c.height, 2.0);
    EXPECT_NEAR(double(f.field("water_flow")(k, 1)), flow, 0.01 * flow);
    EXPECT_NEAR(double(f.field("water_flow")(k, 0)), 0, 0.001 * flow);
  }
  // K i A, i the gradient of the head; what comes in leaves.
  const EnergyRow a = solver.energy();
  EXPECT_LT(std::abs(lost_mass(a, start)), 1e-11);
  solver.advance_to(c.at(1), silent);
  const EnergyRow b = solver.energy();
  const double discharge = c.permeability * (below - above) / (1000 * 9.81 * c.height) * width;
  EXPECT_NEAR((b.darcy - a.darcy) / c.at(0.2), discharge * (below - above), 0.01 * discharge * (below - above));
  EXPECT_NEAR((b.water_inflow - a.water_inflow) / c.at(0.2), 0, 1e-3 * 1000 * discharge);
}

TEST_P(PoreWaterBy, AGivenFlowRaisesThePressureOfAClosedBox) {
  for (const bool through_traction : {false, true}) {
    WaterColumn c = small_column();
    c.pressure = GetParam();
    c.load = through_traction ? 1e-9 : 0;
    Scene s = scene_of(c);
    const double width = 2 * c.spacing(), flux = 1e-7;
    if (through_traction) {
      s.boundaries.back().second.drained = false;
      s.boundaries.back().second.flux_m_s = flux;
    } else {
      s.boundaries[0].second.flux_m_s = flux;
      s.boundaries.emplace_back("top", line({0, c.height}, {width, c.height}, "roller"));
    }
    Solver solver(options_of(c), s, 1);
    const EnergyRow start = solver.energy();
    const double time = c.at(0.1);
    solver.advance_to(time, silent);
    const EnergyRow e = solver.energy();
    EXPECT_NEAR(e.water_inflow, 1000 * flux * width * time, 1e-9 * e.water_inflow);
    EXPECT_LT(std::abs(lost_mass(e, start)), 1e-12);
    EXPECT_LT(std::abs(e.residual), (through_traction ? 0.04 : 0.01) * std::abs(e.external));
    if (through_traction) continue;  // the top rises freely
    double mean = 0;
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) mean += double(f.field("pressure")(k, 0)) / double(f.u.size());
    const double expected = c.bulk / c.porosity * flux * time / c.height;
    EXPECT_NEAR(mean, expected, 0.01 * expected);
  }
}

TEST(PoreWater, WhatIsBelowTheLevelIsFullAndHydrostaticAtTheStart) {
  WaterColumn c = small_column();
  c.load = 0;
  c.gravity = 10;
  Scene s = scene_of(c);
  s.water->level_m = 0.04;
  Solver solver(options_of(c), s, 1);
  const MotionFrame f = solver.frame();
  double mass = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const double depth = 0.04 - s.particles.x0[k].y(), p = std::max(0.0, depth) * 1000 * 10;
    EXPECT_NEAR(double(f.field("pressure")(k, 0)), p, 1e-3);
    EXPECT_NEAR(double(f.field("porosity")(k, 0)), 0.3, 1e-7);
    // (What the surface cuts holds a part.)
    const double full = depth > 0 ? 1 + p / c.bulk : std::max(0.0, 1 + depth / (0.5 * c.spacing()));
    mass += double(s.particles.area[k]) * 0.3 * 1000 * full;
  }
  EXPECT_NEAR(solver.energy().water_mass, mass, 1e-12 * mass);
}

// Soil and water at rest stay so, inside a slope and under a lake beside it, and the lake's load is there.
TEST_P(PoreWaterBy, ASlopeBesideALakeStaysAtRest) {
  const double h = 0.1, level = 0.8;
  using enum ShapeKind;
  // Where the case states no tolerance, too.
  for (const auto& [shape, locking, stated] : {std::tuple{bilinear, Locking::fbar, true}, {gimp, Locking::none, true}, {gimp, Locking::fbar, true}, {bspline, Locking::none, true}, {bspline, Locking::fbar, true},
                                               {bilinear, Locking::fbar, false}, {gimp, Locking::fbar, false}, {bspline, Locking::none, false}, {bspline, Locking::fbar, false}}) {
    Scene s = scene(Grid{{0, 0}, {h, h}, 26, 13}, {{"soil", Polygon({{0, 0}, {2.5, 0}, {2.5, 0.3}, {2, 0.3}, {1, 1}, {0, 1}}, "soil")}},
                    {saturated(1e7, 0.3, 0.35, 1e-4)});
    s.water.emplace();
    s.water->bulk_modulus_pa = 1e9;
    s.water->level_m = level;
    s.boundaries = {{"base", line({0, 0}, {2.5, 0}, "fixed")},
                    {"left", line({0, 0}, {0, 1.2}, "roller")},
                    {"right", line({2.5, 0}, {2.5, 1.2}, "roller")}};
    MpmOptions o = options({0, -9.81});
    o.shape = shape;
    o.transfer = shape == ShapeKind::bspline ? TransferKind::apic : TransferKind::flip;
    o.locking = locking;
    if (stated) o.equilibrium_tolerance = 1e-10;
    o.end_at_rest = false;
    o.pressure = GetParam();
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    const EnergyRow start = solver.energy();
    solver.advance_to(0.005, silent);
    const MotionFrame f = solver.frame();
    double fastest = 0, weight = 0;
    for (std::size_t k = 0; k < f.v.size(); ++k) {
      fastest = std::max(fastest, std::hypot(double(f.v[k][0]), double(f.v[k][1])));
      const double y = s.particles.x0[k].y();
      EXPECT_NEAR(double(f.field("pressure")(k, 0)), 9810 * std::max(0.0, level - y), stated ? 2e-2 : 1);
      if (s.particles.x0[k].x() > 2.2 && y < h) weight += double(f.field("stress")(k, 1));
    }
    EXPECT_LT(fastest, 1e-6 * std::sqrt(9.81)) << name_of(shape) << " " << name_of(locking);
    EXPECT_LT(std::abs(lost_mass(solver.energy(), start)), 1e-13);
    EXPECT_LT(weight, 0);
  }
}

// Effective stress under a lake is that of the submerged weight, whatever its depth.
TEST(PoreWater, ADeepLakeDoesNotLoadTheSkeleton) {
  double stress[2];
  for (const int k : {0, 1}) {
    WaterColumn c = small_column();
    c.load = 0;
    c.gravity = 9.81;
    Scene s = scene_of(c);
    s.water->level_m = k == 0 ? c.height : 5.0;
    MpmOptions o = options_of(c);
    o.initial_equilibrium = true;
    o.equilibrium_tolerance = 1e-9;
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    const MotionFrame f = solver.frame();
    double sum = 0;
    for (std::size_t n = 0; n < f.u.size(); ++n) sum += double(f.field("stress")(n, 1)) / double(f.u.size());
    stress[k] = sum;
    const double buoyant = (c.density() - 1000) * 9.81 * 0.5 * c.height;
    EXPECT_NEAR(sum, -buoyant, 0.01 * buoyant);
  }
  EXPECT_NEAR(stress[0], stress[1], 1e-3 * std::abs(stress[0]));  // (the deeper water is denser)
}

// Kozeny and Carman's K, in proportion to n^3/(1 - n)^2: of the soil, and of the flow through one that was compressed.
TEST(PoreWater, PermeabilityFollowsThePorosityWhereItIsAskedTo) {
  const WaterOptions water;
  MaterialOptions m = saturated(1e7, 0.2, 0.3, 1e-5);
  EXPECT_EQ(pore_soil(m, "soil", &water).mobility_at(0.2), pore_soil(m, "soil", &water).mobility);
  m.permeability = PermeabilityLaw::kozeny_carman;
  const PoreSoil soil = pore_soil(m, "soil", &water);
  EXPECT_NEAR(soil.mobility_at(0.2) / soil.mobility, 8.0 / 27 * 0.49 / 0.64, 1e-12);
  double flow[2];
  for (const bool follows : {false, true}) {
    WaterColumn c = small_column();
    c.load = 0;
    c.young = 1e5;
    c.permeability = 1e-4;
    c.bulk = 3e6;
    Scene s = scene_of(c);
    if (follows) s.materials[0].permeability = PermeabilityLaw::kozeny_carman;
    s.boundaries[0].second.pressure_pa = -4e3;  // suction at the base compresses
    Solver solver(options_of(c), s, 1);
    solver.advance_to(c.at(1.5), silent);
    const MotionFrame f = solver.frame();
    double ratio = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) ratio += soil.mobility_at(double(f.field("porosity")(k, 0))) / soil.mobility / double(f.u.size());
    double sum = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) sum += double(f.field("water_flow")(k, 1)) / double(f.u.size());
    flow[follows] = follows ? sum / ratio : sum;
    EXPECT_LT(ratio, 0.95);
  }
  EXPECT_NEAR(flow[1], flow[0], 0.02 * std::abs(flow[0]));
}

// The level's height between its times, and the pressure of what it drives.
TEST_P(PoreWaterBy, TheLevelOutsideMovesAsItIsTold) {
  WaterColumn c = small_column();
  c.pressure = GetParam();
  c.load = 0;
  c.gravity = 9.81;
  c.permeability = 1e-3;
  Scene s = scene_of(c);
  const double end = c.at(4);
  s.water->level_history = {{0.1 * end, 0.3}, {0.5 * end, 0.2}, {0.6 * end, 0.26}};
  MpmOptions o = options_of(c);
  o.initial_equilibrium = true;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  const EnergyRow start = solver.energy();
  const auto head = [&] {
    const MotionFrame f = solver.frame();
    double sum = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k)
      sum += (double(f.field("pressure")(k, 0)) / 9810 + s.particles.x0[k].y()) / double(f.u.size());
    return sum;
  };
  EXPECT_NEAR(head(), 0.3, 1e-5);
  solver.advance_to(end, silent);
  EXPECT_NEAR(head(), 0.26, 1e-3);
  EXPECT_LT(std::abs(lost_mass(solver.energy(), start)), 1e-11);
}

// A column under its own weight whose water follows a level, impervious as it is: below the level the pressure rises on average by that of
// the water that came over it. (Points of a cell share it unevenly; momentum sees the mean.)
TEST(PoreWater, GroundwaterFollowsALevelThatIsImposed) {
  WaterColumn c = small_column();
  c.load = 0;
  c.gravity = 9.81;
  c.permeability = 1e-12;
  Scene s = scene_of(c);
  const double end = 0.02, low = 0.03, high = 0.05;
  s.water->level_history = {{0.1 * end, low}, {0.6 * end, high}};
  s.water->groundwater = Groundwater::level;
  MpmOptions o = options_of(c);
  o.initial_equilibrium = true;
  o.damping = 0.1;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  const EnergyRow start = solver.energy();
  const MotionFrame before = solver.frame();
  solver.advance_to(end, silent);
  const MotionFrame after = solver.frame();
  double rise = 0;
  int points = 0;
  for (std::size_t k = 0; k < after.u.size(); ++k) {
    const double y = s.particles.x0[k].y();
    EXPECT_NEAR(double(before.field("pressure")(k, 0)), 9810 * std::max(0.0, low - y), 1);
    EXPECT_GE(double(after.field("pressure")(k, 0)), 0);
    if (y > 0.02) continue;
    rise += double(after.field("pressure")(k, 0)) - double(before.field("pressure")(k, 0));
    ++points;
  }
  EXPECT_NEAR(rise / points, 9810 * (high - low), 0.15 * 9810 * (high - low));
  EXPECT_GT(solver.energy().water_inflow, 0);
  EXPECT_LT(std::abs(lost_mass(solver.energy(), start)), 1e-11);
}

TEST(PoreWater, DrainedMaterialHasNoExcessPressure) {
  WaterColumn c = small_column();
  Scene s = scene_of(c);
  s.materials[0].drained = true;
  s.materials[0].permeability_m_s.reset();
  Solver solver(options_of(c), s, 1);
  solver.advance_to(c.at(0.05), silent);
  const MotionFrame f = solver.frame();
  for (std::size_t k = 0; k < f.u.size(); ++k) EXPECT_EQ(double(f.field("pressure")(k, 0)), 0);
  EXPECT_EQ(solver.energy().water_mass, 0);
}

TEST_P(PoreWaterBy, BitsDoNotDependOnThreadsNorOnARestart) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    WaterColumn c = small_column();
    c.cells = 12;
    c.gravity = 9.81;
    c.shape = shape;
    c.pressure = GetParam();
    Scene s = scene_of(c);
    s.water->level_m = c.height;
    expect_same_bits(options_of(c), s);
  }
}

}  // namespace
}  // namespace pivnp::mpm

// Sleeping beside water in the pores (mpm/step/sleep.hpp): pressures stay within the tolerance, water is where it was, and what
// presses on sleepers through their water wakes them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "pivnp/core/error.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double h = 0.01, width = 0.32, depth = 0.06, slow = 2e-4;

// A saturated bed under a lake, loaded at its left end. `level`: of the water.
Scene bed(double level, double load = 2e3) {
  Scene s = scene(Grid{{0, 0}, {h, h}, 33, 10}, {rectangle("soil", 0, 0, width, depth)}, {saturated(1e7, 0.3, 0.35, 1e-4)});
  s.water.emplace();
  s.water->bulk_modulus_pa = 2e7;
  s.water->level_m = level;
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 0.09}, "roller")},
                  {"right", line({width, 0}, {width, 0.09}, "roller")}};
  if (load > 0) {
    BoundaryOptions foot = line({0, depth}, {0.08, depth}, "traction");
    foot.traction_pa = {0, -load};
    foot.rise_s = 5e-3;
    foot.drained = true;
    s.boundaries.emplace_back("foot", foot);
  }
  return s;
}

MpmOptions in_bed(PressureScheme pressure, bool sleeps) {
  MpmOptions o = options({0, -9.81});
  o.pressure = pressure;
  o.damping = 0.1;
  o.transfer = TransferKind::apic;  // what rests is asleep soon
  o.end_at_rest = false;
  if (sleeps) o.sleep_below_m_s = slow;
  return o;
}

double greatest_difference_of_pressure(const MotionFrame& a, const MotionFrame& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.u.size(); ++k)
    most = std::max(most, std::abs(double(a.field("pressure")(k, 0)) - double(b.field("pressure")(k, 0))));
  return most;
}

// The stress that the tolerance holds back, by the skeleton's wave.
double tolerance_of_pressure() {
  WaterColumn c;
  c.young = 1e7, c.poisson = 0.3, c.porosity = 0.35;
  return std::sqrt(c.density() * c.modulus()) * slow;
}

struct Wet {
  const char* name;
  PressureScheme pressure;
  double level;
};
class WetSleep : public testing::TestWithParam<Wet> {};

TEST_P(WetSleep, WhatIsLeftOutIsBoundedAndWaterIsKept) {
  Solver with(in_bed(GetParam().pressure, true), bed(GetParam().level), 1), without(in_bed(GetParam().pressure, false), bed(GetParam().level), 1);
  EnergyRow start;
  double excess = 0, settled = 0;
  for (Solver* s : {&with, &without}) {
    s->find_initial_equilibrium(silent);
    start = s->energy();
    s->advance_to(0.005, silent);
    const MotionFrame loaded = s->frame();
    for (std::size_t k = 0; k < loaded.u.size(); ++k) excess = std::max(excess, std::abs(double(loaded.field("excess_pressure")(k, 0))));
    s->advance_to(0.06, silent);
  }
  const Solver::Slept slept = with.slept();
  const MotionFrame a = with.frame(), b = without.frame();
  for (const auto& u : b.u) settled = std::max(settled, std::abs(double(u[1])));
  std::printf("%s: slept %.3f, u %.3g of %.3g (bound %.3g), pressure %.3g of %.3g (tolerance %.3g)\n", GetParam().name, slept.share,
              greatest_difference(a, b), settled, slept.displacement_m, greatest_difference_of_pressure(a, b), excess, tolerance_of_pressure());
  EXPECT_GT(slept.share, 0.1);
  EXPECT_LT(greatest_difference(a, b), slept.displacement_m);
  EXPECT_LT(slept.displacement_m, settled);
  EXPECT_LT(greatest_difference_of_pressure(a, b), tolerance_of_pressure());
  EXPECT_GT(excess, 5 * tolerance_of_pressure());
  const EnergyRow end = with.energy();
  EXPECT_LT(std::abs(end.water_mass - start.water_mass - end.water_inflow), 1e-12 * start.water_mass);
  EXPECT_NEAR(end.water_inflow, without.energy().water_inflow, 0.02 * std::abs(without.energy().water_inflow) + 1e-9 * start.water_mass);
  EXPECT_LT(std::abs(end.residual - without.energy().residual), 0.01 * end.external);
}
INSTANTIATE_TEST_SUITE_P(Sleep, WetSleep,
                         testing::Values(Wet{"explicit", PressureScheme::in_steps, 0.09}, Wet{"projected", PressureScheme::projected, 0.09},
                                         Wet{"front", PressureScheme::in_steps, 0.035}),
                         [](const auto& of) { return std::string(of.param.name); });

// Nothing but the level moves: what slept follows it as what never did.
TEST(WetSleepers, WakeAsTheLakeFalls) {
  MotionFrame end[2];
  for (const bool sleeps : {false, true}) {
    Scene s = bed(0, 0);
    s.water->level_m = std::nullopt;
    s.water->level_history = {{0, 0.5}, {0.03, 0.5}, {0.05, 0.1}};
    MpmOptions o = in_bed(PressureScheme::in_steps, sleeps);
    Solver solver(o, s, 1);
    solver.find_initial_equilibrium(silent);
    solver.advance_to(0.05, silent);
    EXPECT_EQ(solver.slept().share, 0);  // a level is still to move
    solver.advance_to(0.08, silent);
    end[sleeps] = solver.frame();
  }
  EXPECT_LT(greatest_difference_of_pressure(end[0], end[1]), tolerance_of_pressure());
}

// Water pressed in at the left end, under an impervious cover that is free to rise: by less from cell to cell than wakes what rests,
// but by more in the end.
TEST(WetSleepers, WakeByThePressureThatReachesThem) {
  MotionFrame end[2];
  double inflow[2];
  const Scene s = [] {
    Scene pressed = bed(0, 0);
    pressed.water->level_m = std::nullopt;
    pressed.materials[0].permeability_m_s = 1e-4;
    BoundaryOptions top = line({0, depth}, {width, depth}, "traction");  // impervious
    top.traction_pa = {0, -1};
    pressed.boundaries.emplace_back("top", top);
    pressed.boundaries[1].second.pressure_pa = 450;
    return pressed;
  }();
  for (const bool sleeps : {false, true}) {
    MpmOptions o = in_bed(PressureScheme::in_steps, sleeps);
    o.gravity_m_s2 = {0, 0};
    o.initial_equilibrium = false;
    o.damping = 0.5;
    Solver solver(o, s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(0.03, silent);
    const double early = solver.slept().share;
    solver.advance_to(0.12, silent);
    if (sleeps) {
      EXPECT_GT(early, 0.05);
    }
    EXPECT_LT(std::abs(solver.energy().water_mass - start.water_mass - solver.energy().water_inflow), 1e-12 * start.water_mass);
    end[sleeps] = solver.frame();
    inflow[sleeps] = solver.energy().water_inflow;
  }
  EXPECT_NEAR(inflow[1], inflow[0], 0.01 * inflow[0]);
  double reached = 0;  // in the third block of cells from the left
  for (std::size_t k = 0; k < end[0].u.size(); ++k)
    if (s.particles.x0[k].x() > 20 * h && s.particles.x0[k].x() < 23 * h) reached = std::max(reached, double(end[1].field("pressure")(k, 0)));
  EXPECT_GT(reached, tolerance_of_pressure());
  EXPECT_LT(greatest_difference_of_pressure(end[0], end[1]), tolerance_of_pressure());
}

// Loaded undrained, what hardly conducts moves slower than any tolerance, and does not sleep while its pressure falls.
TEST(WetSleepers, AreNotWhatConsolidates) {
  MotionFrame end[2];
  for (const bool sleeps : {false, true}) {
    Scene s = bed(0, 0);
    s.water->level_m = std::nullopt;
    s.materials[0].permeability_m_s = 3e-7;
    BoundaryOptions all = line({0, depth}, {width, depth}, "traction");
    all.traction_pa = {0, -2e3};
    all.rise_s = 5e-3;
    all.drained = true;
    s.boundaries.emplace_back("all", all);
    MpmOptions o = in_bed(PressureScheme::projected, sleeps);
    o.gravity_m_s2 = {0, 0};
    o.initial_equilibrium = false;
    o.damping = 0.3;
    Solver solver(o, s, 1);
    solver.advance_to(0.25, silent);
    end[sleeps] = solver.frame();
    if (sleeps) {
      EXPECT_LT(solver.slept().share, 0.05);
    }
  }
  EXPECT_LT(greatest_difference_of_pressure(end[0], end[1]), tolerance_of_pressure());
}

// Flow that a boundary gives goes on where nothing else moves. (Asleep, the box took none after two hundredths of the
// time.)
TEST(WetSleepers, AGivenFlowKeepsMaterialAwake) {
  const double q = 1e-6, time = 0.1;
  Scene s =
      scene(Grid{{0, 0}, {h, h}, 9, 10}, {rectangle("soil", 0, 0, 0.08, depth)}, {saturated(1e7, 0.3, 0.35, 1e-4)});
  s.water.emplace();
  s.water->bulk_modulus_pa = 2e7;
  BoundaryOptions top = line({0, depth}, {0.08, depth}, "traction");
  top.traction_pa = {0, 0};
  top.flux_m_s = q;
  s.boundaries = {{"base", line({0, 0}, {0.08, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 0.09}, "roller")},
                  {"right", line({0.08, 0}, {0.08, 0.09}, "roller")},
                  {"top", top}};
  MpmOptions o = in_bed(PressureScheme::in_steps, true);
  o.gravity_m_s2 = Pair{0, 0};
  o.initial_equilibrium = false;
  o.energy_limit = 1e9;
  Solver solver(o, s, 1);
  solver.advance_to(time, silent);
  EXPECT_NEAR(solver.energy().water_inflow, 1000 * q * 0.08 * time, 1e-6 * 1000 * q * 0.08 * time);
}

TEST(WetSleepers, BitsDependOnNeitherThreadsNorRestart) {
  for (const PressureScheme pressure : {PressureScheme::in_steps, PressureScheme::projected}) {
    const auto start = [&](int threads) {
      auto solver = std::make_unique<Solver>(in_bed(pressure, true), bed(0.09), threads);
      solver->find_initial_equilibrium(silent);
      return solver;
    };
    const auto one = start(1), two = start(2);
    const auto again = std::make_unique<Solver>(in_bed(pressure, true), bed(0.09), 1);
    for (const auto& s : {one.get(), two.get()}) s->advance_to(0.04, silent);
    EXPECT_GT(one->slept().share, 0);
    again->load(one->save());
    for (const auto& s : {one.get(), two.get(), again.get()}) s->advance_to(0.041, silent);
    EXPECT_TRUE(one->save() == two->save());
    EXPECT_TRUE(one->save() == again->save());
  }
}

}  // namespace
}  // namespace pivnp::mpm

// Sleeping (mpm/step/sleep.hpp): what it leaves out stays within the bound it states, energy closes, sleepers wake, and the
// bits depend on neither threads nor restarts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "pivnp/core/error.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double h = 0.01, width = 0.8, depth = 0.06;

// A bed of sand between walls; a plate is pressed into its left end.
Scene pressed(const MaterialOptions& material) {
  Scene s = scene(Grid{{0, 0}, {h, h}, 81, 12}, {rectangle("soil", 0, 0, width, depth)}, {material});
  s.boundaries = {{"base", line({0, 0}, {width, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 0.11}, "roller")},
                  {"right", line({width, 0}, {width, 0.11}, "roller")}};
  RigidOptions plate;
  plate.polygon_m = {{0.02, depth + 0.001}, {0.06, depth + 0.001}, {0.06, depth + 0.02}, {0.02, depth + 0.02}};
  plate.velocity_m_s = {0, -0.05};
  s.bodies = {{"plate", plate}};
  return s;
}

MpmOptions pressing(const std::string& scheme) {
  MpmOptions o = options({0, -9.81});
  o.scheme = *value_named<SchemeName>(scheme);
  o.k0 = 0.43;
  o.sleep_below_m_s = 0.01;
  return o;
}

class SleepingSchemes : public testing::TestWithParam<const char*> {};

TEST_P(SleepingSchemes, WhatIsLeftOutIsBoundedAndBooked) {
  SilentProgress silent;
  MpmOptions awake = pressing(GetParam());
  awake.sleep_below_m_s.reset();
  const MaterialOptions material = sand(35, 20e6);
  Solver with(pressing(GetParam()), pressed(material), 1), without(awake, pressed(material), 1);
  for (Solver* s : {&with, &without}) {
    s->find_initial_equilibrium(silent);
    s->advance_to(0.06, silent);
  }
  const Solver::Slept slept = with.slept();
  EXPECT_GT(slept.share, 0.3);
  EXPECT_GT(slept.energy, 0);
  EXPECT_LT(slept.displacement_m, 0.01 * 0.06 + 1e-3);
  // (The bound is that of blocks that sleep; sand that is awake under the plate shears by last digits.)
  const MotionFrame asleep = with.frame(), moved = without.frame();
  double most = 0;
  for (std::size_t k = 0; k < moved.u.size(); ++k)
    if (with.particles().x0[k].x() > 0.06 + 2 * depth)
      most = std::max(most, std::hypot(double(asleep.u[k][0] - moved.u[k][0]), double(asleep.u[k][1] - moved.u[k][1])));
  EXPECT_LT(most, slept.displacement_m);
  const EnergyRow a = with.energy(), b = without.energy();
  EXPECT_LT(std::abs(a.residual - b.residual), 0.01 * b.external);
  EXPECT_NEAR(a.external, b.external, 0.05 * b.external);
  EXPECT_EQ(without.slept().share, 0);
}
INSTANTIATE_TEST_SUITE_P(Sleep, SleepingSchemes, testing::Values("default", "geopart"),
                         [](const auto& scheme) { return std::string(scheme.param); });

// An elastic bed in equilibrium sleeps as a whole; a block that falls on it wakes it, and it answers as one that never
// slept.
TEST(Sleep, AFallingBlockWakesTheBed) {
  SilentProgress silent;
  MotionFrame end[2];
  EnergyRow energy[2];
  for (int with = 0; with < 2; ++with) {
    Scene s = scene(Grid{{0, 0}, {h, h}, 41, 20},
                    {rectangle("bed", 0, 0, 0.4, depth), rectangle("block", 0.1, 0.12, 0.16, 0.16)},
                    {elastic(2e6, 0.3, 1600), elastic(2e6, 0.3, 1600)});
    s.boundaries = {{"base", line({0, 0}, {0.4, 0}, "fixed")},
                    {"left", line({0, 0}, {0, 0.19}, "roller")},
                    {"right", line({0.4, 0}, {0.4, 0.19}, "roller")}};
    for (const std::int32_t label : s.particles.label) s.v0.push_back(label == 1 ? Vec2(0, -1) : Vec2(0, 0));
    MpmOptions o = options({0, 0});
    o.initial_equilibrium = false;
    if (with) o.sleep_below_m_s = 1e-3;
    Solver solver(o, s, 1);
    solver.advance_to(0.045, silent);  // the block has half a cell to go
    if (with) {
      EXPECT_GT(solver.slept().share, 0.2);
      EXPECT_LT(solver.slept().displacement_m, 1e-4);
    }
    solver.advance_to(0.08, silent);
    end[with] = solver.frame();
    energy[with] = solver.energy();
  }
  double sunk = 0;
  for (const auto& u : end[0].u) sunk = std::max(sunk, std::abs(double(u[1])));
  EXPECT_LT(greatest_difference(end[0], end[1]), 0.02 * sunk);
  EXPECT_NEAR(energy[1].elastic, energy[0].elastic, 5e-4 * energy[0].kinetic);
  EXPECT_NEAR(energy[1].residual, energy[0].residual, 1e-3 * energy[0].kinetic);
}

TEST(Sleep, BitsDependOnNeitherThreadsNorRestart) {
  SilentProgress silent;
  for (const char* scheme : {"default", "geopart"}) {
    MpmOptions o = pressing(scheme);
    o.initial_equilibrium = false;
    const auto start = [&](int threads) { return std::make_unique<Solver>(o, pressed(sand(35, 20e6)), threads); };
    const auto one = start(1), two = start(2), again = start(1);
    for (const auto& s : {one.get(), two.get()}) s->advance_to(0.03, silent);
    EXPECT_GT(one->slept().share, 0.02) << scheme;
    again->load(one->save());
    for (const auto& s : {one.get(), two.get(), again.get()}) s->advance_to(0.036, silent);
    EXPECT_TRUE(one->save() == two->save()) << scheme;
    EXPECT_TRUE(one->save() == again->save()) << scheme;
  }
}

TEST(Sleep, RefusesASpeedOfZero) {
  MpmOptions o = pressing("default");
  o.sleep_below_m_s = 0.0;
  EXPECT_THROW(Solver(o, pressed(sand(35)), 1), InputError);
}

// What would not wake by what touches it must not sleep.
TEST(Sleep, IsRefusedBesideContactsAndTiedSides) {
  const auto message = [](auto&& change) -> std::string {
    Scene s = scene(Grid{{0, 0}, {h, h}, 21, 12},
                    {rectangle("bed", 0, 0, 0.2, 0.05), rectangle("block", 0.05, 0.05, 0.15, 0.1)},
                    {elastic(1e6, 0.3, 1600), elastic(1e6, 0.3, 1600)});
    change(s);
    MpmOptions o = options();
    o.sleep_below_m_s = 0.01;
    try {
      Solver solver(o, s, 1);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(message([](Scene&) {}), "");
  const std::string contact = message([](Scene& s) {
    ContactOptions face;
    face.regions = {"block"};
    s.contacts = {{"face", face}};
  });
  EXPECT_NE(contact.find("mpm.sleep_below_m_s: given beside a [contact.NAME]"), std::string::npos) << contact;
  const std::string tied = message([](Scene& s) {
    BoundaryOptions sides = line({0, 0}, {0, 0.11}, "tied");
    sides.across_m = Pair{0.2, 0};
    s.boundaries = {{"sides", sides}};
  });
  EXPECT_NE(tied.find("mpm.sleep_below_m_s: given beside a tied boundary"), std::string::npos) << tied;
}

}  // namespace
}  // namespace pivnp::mpm

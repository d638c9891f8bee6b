// What changes with time: gravity, gates, densities, moving plates, excavation, strength; initial stress by K0.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "mpm/constraint/restraints.hpp"
#include "mpm/material/model.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
Scene flying_block() {
  return scene(Grid{{0, 0}, {0.01, 0.01}, 21, 101}, {rectangle("block", 0.05, 0.85, 0.15, 0.95)},
               {elastic(1e6, 0.2, 1500)});
}

TEST(Loading, GravityRisesLinearly) {
  MpmOptions o = options({0, -9.81});
  o.gravity_from_m_s2 = Pair{0, 0};
  o.gravity_ramp_s = 0.1;
  Solver solver(o, flying_block(), 1);
  solver.advance_to(0.2, silent);
  const double mass = 0.01 * 1500, exact = -9.81 * (0.05 + 0.1);  // half of the ramp, then all
  EXPECT_NEAR(solver.momentum().y() / mass, exact, 1e-10);  // (velocities are shown at their time, not half a step late)
  const EnergyRow e = solver.energy();
  EXPECT_NEAR(e.external, 0.5 * mass * exact * exact, 1e-3 * e.external);
  EXPECT_LT(std::abs(e.residual), 1e-3 * e.external);
}

// What changes in time is taken where velocities between two states make it second order: a bar under gravity that ramps up,
// against a run with a sixteenth of the step. (In the middle of the step gravity would be first order: 3.7e-3. Steps of two
// lengths, as runs end on time, keep the order from being 2 exactly.)
TEST(Loading, GravityThatRampsUpKeepsSecondOrder) {
  const auto end = [](double courant) {
    Scene s = column(0.1, elastic(1e6, 0.0, 1000));
    MpmOptions o = conservative({0, -20});  // (APIC takes a little energy at each step)
    o.gravity_from_m_s2 = Pair{0, 0};
    o.gravity_ramp_s = 0.012;  // longer than the run: a ramp's end is not smooth
    o.courant = courant;
    Solver solver(o, s, 1);
    solver.advance_to(0.01, silent);
    double sum = 0;
    for (const auto& u : solver.frame().u) sum += double(u[1]);
    return sum / double(solver.particles().size());
  };
  const double exact = end(0.025), coarse = end(0.4) - exact, fine = end(0.2) - exact;
  EXPECT_LT(std::abs(coarse), 2e-4 * std::abs(exact));
  EXPECT_GT(std::log2(std::abs(coarse / fine)), 1.3) << coarse << ' ' << fine;
}

TEST(Loading, ADensityThatRisesIsCarriedByTheBase) {
  MaterialOptions m = elastic(1e6, 0.3, 1000);
  m.density_end_kg_m3 = 2000;
  m.density_until_s = 0.5;
  MpmOptions o = options({0, -10});
  o.damping = 0.3;
  Solver solver(o, column(0.2, m), 1);
  solver.find_initial_equilibrium(silent);
  EXPECT_NEAR(mean_stress(solver, 1, 1), -1000 * 10 * 0.1, 20);
  solver.advance_to(0.7, silent);
  EXPECT_NEAR(mean_stress(solver, 1, 1), -2000 * 10 * 0.1, 40);
}

TEST(Loading, ADensityThatRisesInFlightIsBooked) {
  Scene s = flying_block();
  s.materials[0].density_end_kg_m3 = 3000;
  s.materials[0].density_until_s = 0.2;
  Solver solver(options({0, -9.81}), s, 1);
  solver.advance_to(0.2, silent);
  EXPECT_NEAR(solver.momentum().y() / (0.01 * 3000), -9.81 * 0.2, 1e-6);  // mass comes at the block's velocity
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.residual), 1e-2 * e.external);
}

TEST(Loading, APlateThatMovesStretchesABar) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 31, 8}, {rectangle("bar", 0, 0, 0.2, 0.05)}, {elastic(1e6, 0.0, 1000)});
  s.boundaries = {{"held", line({0, 0}, {0, 0.06}, "fixed")}, {"pulled", line({0.2, 0}, {0.2, 0.06}, "fixed")}};
  s.boundaries[1].second.velocity_m_s = Pair{0.01, 0};
  MpmOptions o = options();
  o.damping = 0.3;
  Solver solver(o, s, 1);
  solver.advance_to(0.1, silent);
  const double strain = std::log(1 + 0.01 * 0.1 / 0.2);
  EXPECT_NEAR(mean_stress(solver, 0, 1), 1e6 * strain, 0.02 * 1e6 * strain);
}

TEST(Loading, WhatIsExcavatedWeighsNoMore) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 25},
                  {rectangle("below", 0, 0, 0.1, 0.1), rectangle("above", 0, 0.1, 0.1, 0.2)},
                  {elastic(1e6, 0.3, 1000), elastic(1e6, 0.3, 1000)});
  s.materials[1].removed_s = 0.05;
  s.boundaries = column(0.2, s.materials[0]).boundaries;
  MpmOptions o = options({0, -10});
  o.damping = 0.3;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  EXPECT_NEAR(mean_stress(solver, 1, 0.1), -1500, 20);
  solver.advance_to(0.5, silent);
  EXPECT_EQ(solver.ended(), s.particles.size() / 2);
  EXPECT_NEAR(mean_stress(solver, 1, 0.1), -500, 10);
  std::size_t removed = 0;
  for (const EndReason reason : solver.particles().end_reason) removed += reason == EndReason::removed;
  EXPECT_EQ(removed, s.particles.size() / 2);
  EXPECT_LT(std::abs(solver.energy().residual), 0.02 * solver.energy().external + 0.05);
}

// A vertical cut of height H in clay: gamma H/c = 2 stands, 6 cannot (limits: 3.77 from below, 3.83 from above).
TEST(Loading, ACutFailsWhenItsStrengthIsReduced) {
  MaterialOptions clay = elastic(2e6, 0.3, 2000);
  clay.model = "tresca";
  clay.shear_strength_pa = 2000 * 10 * 0.2 / 2;
  clay.reduction_factor = 3;
  clay.reduction_from_s = 0.1;
  Scene s = scene(Grid{{0, 0}, {0.02, 0.02}, 41, 13}, {rectangle("clay", 0, 0, 0.4, 0.2)}, {clay});
  s.boundaries = {{"base", line({0, 0}, {0.8, 0}, "fixed")}, {"left", line({0, 0}, {0, 0.24}, "roller")}};
  Solver solver(options({0, -10}), s, 1);
  solver.find_initial_equilibrium(silent);
  const auto most = [&] {
    double u = 0;
    for (const auto& d : solver.frame().u) u = std::max(u, std::hypot(double(d[0]), double(d[1])));
    return u;
  };
  solver.advance_to(0.1, silent);
  EXPECT_LT(most(), 1e-3);
  solver.advance_to(0.3, silent);
  EXPECT_GT(most(), 0.02);

  // A restart inside the run goes on with the reduced strength and the same bits.
  const auto saved = solver.save();
  Solver again(options({0, -10}), s, 1);
  again.load(saved);
  solver.advance_to(0.35, silent);
  again.advance_to(0.35, silent);
  EXPECT_EQ(solver.save(), again.save());
}

TEST(Loading, CohesionMayBeReducedAlone) {
  MaterialOptions clay = elastic(2e7, 0.33, 2000);
  clay.model = "mohr_coulomb";
  clay.friction_deg = 28;
  clay.cohesion_pa = 2000;
  clay.cohesion_residual_pa = 500;
  const MaterialOptions both = reduced(clay, 2);
  EXPECT_NEAR(std::tan(both.friction_deg * M_PI / 180), std::tan(28 * M_PI / 180) / 2, 1e-12);
  clay.reduction_of = ReductionOf::cohesion;
  const MaterialOptions alone = reduced(clay, 2);
  EXPECT_EQ(alone.friction_deg, 28);
  EXPECT_EQ(alone.cohesion_pa, 1000);
  EXPECT_EQ(alone.cohesion_residual_pa, 250);
}

TEST(Loading, StressStartsAtK0) {
  MpmOptions o = options({0, -10});
  o.initial_equilibrium = false;
  o.k0 = 0.7;
  Solver solver(o, column(0.2, elastic(1e6, 0.3, 1000)), 1);
  EXPECT_NEAR(mean_stress(solver, 1, 1), -1000, 1);
  EXPECT_NEAR(mean_stress(solver, 0, 1), -700, 1);
}

TEST(Loading, AGateLetsGoNodeByNode) {
  const Grid grid{{0, 0}, {0.01, 0.01}, 21, 31};
  const GridState g(grid, ShapeKind::bilinear);
  BoundaryOptions gate = line({0.1, 0}, {0.1, 0.2}, "roller");
  gate.withdraw_m_s = Pair{0, 2};
  gate.withdraw_from_s = 0.05;
  const Restraints restraints({{"gate", gate}}, g, Vec2(0.05, 0.1), [](const Vec2&) { return std::array<double, 2>{}; });
  // Its foot is at 2 (t - 0.05): nodes below it, and a little more, are free.
  for (const double t : {0.04, 0.08, 0.1, 0.12, 0.2}) {
    const auto walls = restraints.wall_sides(t, grid, true);
    for (int j = 0; j <= 20; ++j) {
      const double foot = 2 * (t - 0.05), y = 0.01 * j;
      if (y < foot - 0.002) {
        EXPECT_EQ(walls[grid.node(10, j)], 0) << t << " " << y;
      }
      if (y > foot && t < 0.14) {
        EXPECT_NE(walls[grid.node(10, j)], 0) << t << " " << y;
      }
    }
  }
  EXPECT_TRUE(std::isinf(restraints.next_change(0.2)));
}

TEST(Loading, NonsenseNamesItsKey) {
  const auto message = [](const std::function<void(MpmOptions&, Scene&)>& change) -> std::string {
    MpmOptions o = options({0, -10});
    Scene s = column(0.1, sand(30));
    change(o, s);
    try {
      Solver solver(o, s, 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto expect = [&](const std::string& key, const std::function<void(MpmOptions&, Scene&)>& change) {
    EXPECT_NE(message(change).find(key), std::string::npos) << key << ": " << message(change);
  };
  expect("mpm.gravity_ramp_s", [](auto& o, auto&) { o.gravity_ramp_s = 1.0; });
  expect("material.soil.density_until_s", [](auto&, auto& s) { s.materials[0].density_end_kg_m3 = 1.0; });
  expect("material.soil.density_until_s", [](auto&, auto& s) { s.materials[0].density_until_s = 1.0; });
  expect("material.soil.reduction_factor", [](auto&, auto& s) { s.materials[0].reduction_factor = 0.0; });
  expect("material.soil.reduction_of", [](auto&, auto& s) { s.materials[0].reduction_of = ReductionOf::cohesion; });
  expect("material.soil.reduction_until_s", [](auto&, auto& s) {
    s.materials[0].reduction_factor = 2.0;
    s.materials[0].reduction_from_s = 2;
    s.materials[0].reduction_until_s = 1.0;
  });
  expect("material.soil.removed_s", [](auto&, auto& s) { s.materials[0].removed_s = 0.0; });
  expect("boundary.base.velocity_m_s", [](auto&, auto& s) {
    s.boundaries[0].second.type = BoundaryType::frictional;
    s.boundaries[0].second.velocity_m_s = Pair{1, 0};
  });
  expect("boundary.base.withdraw_m_s", [](auto&, auto& s) { s.boundaries[0].second.withdraw_m_s = Pair{0, 0}; });
  expect("boundary.base.traction_pa", [](auto&, auto& s) { s.boundaries[0].second.traction_pa = Pair{0, 1}; });
  expect("boundary.base.follows_face", [](auto&, auto& s) { s.boundaries[0].second.follows_face = true; });
  expect("boundary.base.traction_pa", [](auto&, auto& s) { s.boundaries[0].second.type = BoundaryType::traction; });
  expect("boundary.left.line_m", [](auto&, auto& s) {
    s.boundaries[1].second = line({5, 5}, {6, 6}, "traction");
    s.boundaries[1].second.traction_pa = Pair{0, 1};
  });
  expect("boundary.left.line_m", [](auto&, auto& s) {  // through the material
    s.boundaries[1].second = line({0, 0.05}, {0.1, 0.05}, "traction");
    s.boundaries[1].second.traction_pa = Pair{0, 1};
  });
}

}  // namespace
}  // namespace pivnp::mpm

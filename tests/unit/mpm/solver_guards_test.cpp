// What stops a run, what only ends particles, and what is refused before it begins.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

const Grid guarded_box{{-0.03, 0.02}, {0.01, 0.01}, 61, 51};

TEST(Solver, ParticlesThatLeaveAreEndedNotFatal) {
  Scene s = scene(guarded_box, {rectangle("block", 0.4, 0.2, 0.5, 0.3)}, {elastic(1e5, 0.3, 1000)});
  s.v0.assign(s.particles.size(), Vec2(1.0, 0));
  Solver solver(conservative(), s, 2);
  solver.advance_to(0.1, silent);  // 100 mm: the front 30 mm have left at x = 0.57
  std::size_t ended = 0;
  const MotionFrame frame = solver.frame();
  for (std::size_t k = 0; k < frame.status.size(); ++k) {
    const bool gone = frame.status[k] == ParticleStatus::ended;
    EXPECT_EQ(gone, s.particles.x0[k].x() + 0.1 > 0.57 + 1e-6) << s.particles.x0[k].x();
    EXPECT_EQ(gone, solver.particles().end_reason[k] == EndReason::left_grid);
    if (!gone) continue;
    ++ended;
    EXPECT_NEAR(solver.particles().end[k], 0.57 - s.particles.x0[k].x(), 0.002);
    EXPECT_NEAR(s.particles.x0[k].x() + double(frame.u[k][0]), 0.57, 0.002);
  }
  EXPECT_EQ(ended, 120u);
  EXPECT_NEAR(solver.energy().residual, 0, 1e-9 * solver.energy().kinetic);
  solver.advance_to(0.3, silent);  // the last ones leave; nothing is left to step
  for (const ParticleStatus status : solver.frame().status) EXPECT_EQ(status, ParticleStatus::ended);
}

TEST(Solver, AParticleOnTheBorderWithinRoundOffIsInside) {
  Scene s = scene(guarded_box, {rectangle("block", -0.03, 0.02, 0.07, 0.12)}, {elastic(1e5, 0.3, 1000)});
  s.particles.x0[0] = guarded_box.origin - Vec2(1e-18, 1e-12);
  Solver solver(conservative(), s, 1);
  solver.advance_to(0.001, silent);
  EXPECT_EQ(solver.frame().status[0], ParticleStatus::active);
}

TEST(Solver, BlowUpStopsWithOneLineAndTheLastGoodBalance) {
  Scene s = scene(guarded_box, {rectangle("block", 0.1, 0.1, 0.2, 0.2)}, {elastic(1e5, 0.3, 1000)});
  s.v0.assign(s.particles.size(), Vec2(0, 0));
  s.v0[17] = Vec2(std::nan(""), 0);
  Solver solver(options(), s, 1);
  try {
    solver.advance_to(0.01, silent);
    FAIL() << "expected a RunError";
  } catch (const RunError& e) {
    EXPECT_NE(std::string(e.what()).find("t = 0 s"), std::string::npos) << e.what();
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
  EXPECT_EQ(solver.time(), 0.0);
  EXPECT_EQ(solver.steps(), 0);
  EXPECT_EQ(solver.energy().time, 0.0);
  EXPECT_THROW(solver.frame(), RunError);
  EXPECT_THROW(solver.save(), RunError);
}

TEST(Solver, AStepBeyondTheStableOneStopsWithTheLastGoodBalance) {
  MpmOptions o = conservative({0, -9.81});
  o.courant = 3.0;  // what the options' reader would refuse
  Solver solver(o, column(0.2, elastic(1e6, 0.3, 2000)), 1);
  EXPECT_THROW(solver.advance_to(5.0, silent), RunError);
  EXPECT_LT(solver.time(), 5.0);
  const EnergyRow e = solver.energy();
  EXPECT_LE(e.residual, 0.25 * (e.external + e.damping) + 1e-12);
  EXPECT_EQ(e.time, solver.time());
  EXPECT_EQ(solver.steps() % 100, 0);
  EXPECT_THROW(solver.frame(), RunError);
}

TEST(Solver, BadScenesNameTheirKey) {
  const auto message = [](Scene s, MpmOptions o = options()) -> std::string {
    try {
      Solver solver(o, std::move(s), 1);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const Scene good = scene(guarded_box, {rectangle("clay", 0.1, 0.1, 0.3, 0.2)}, {elastic(1e6, 0.3, 1500)});
  EXPECT_EQ(message(good), "");
  Scene s = good;
  s.boundaries = {{"base", line({5, 5}, {6, 5}, "fixed")}};
  EXPECT_NE(message(s).find("boundary.base"), std::string::npos);
  s.boundaries[0].second.polygon_m = {{0, 0}, {1, 0}, {0, 1}};
  EXPECT_NE(message(s).find("either line_m or polygon_m"), std::string::npos);
  s = good;
  RigidOptions body;
  body.circle_m = {0.2, 0.15, 0.03};
  s.bodies = {{"tbar", body}};
  EXPECT_NE(message(s).find("body.tbar"), std::string::npos);
  s = good;
  s.materials[0].young_pa = 0;
  EXPECT_NE(message(s).find("material.clay.young_pa"), std::string::npos);
  MpmOptions o = options();
  o.locking = Locking::full;
  EXPECT_NE(message(good, o).find("mpm.locking"), std::string::npos);
  s = good;
  s.grid.nx = 20;
  EXPECT_NE(message(s).find("outside"), std::string::npos);
}

}  // namespace
}  // namespace pivnp::mpm

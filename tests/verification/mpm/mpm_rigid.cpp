// A free rigid block on an elastic bed, gravity turned instead of the plane: slides with g (sin t - mu cos t). Criterion:
// 2 %. (Rolling cylinders miss theirs: docs/limits.md.)
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
double slide(double slope_deg, RigidOptions body, double time) {
  const double t = slope_deg * M_PI / 180;
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 71, 31}, {rectangle("bed", 0, 0, 0.7, 0.06)}, {elastic(5e6, 0.3, 2000)});
  s.boundaries = {{"base", line({0, 0}, {0.7, 0}, "fixed")}};
  s.bodies = {{"body", body}};
  Solver solver(options({9.81 * std::sin(t), -9.81 * std::cos(t)}), s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(time, silent);
  return solver.body_displacement(0).x();
}

TEST(MpmRigid, ABlockSlidesOnAnIncline) {
  RigidOptions block;
  block.polygon_m = {{0.1, 0.06}, {0.2, 0.06}, {0.2, 0.11}, {0.1, 0.11}};
  block.mass_kg_m = 10.0;
  for (const double mu : {0.0, 0.3}) {
    block.friction = mu;
    const double t = 30 * M_PI / 180, time = 0.3;
    const double exact = 0.5 * 9.81 * (std::sin(t) - mu * std::cos(t)) * time * time, found = slide(30, block, time);
    pivnp::test::verification_row("free rigid block on an incline, friction " + number(mu),
                                  "path over that of g (sin t - mu cos t) within 2 %", number(found / exact, 4));
    EXPECT_NEAR(found, exact, 0.02 * exact);
  }
}

TEST(MpmRigid, AStandingBlockWeighsOnItsBed) {
  RigidOptions block;
  block.polygon_m = {{0.3, 0.06}, {0.4, 0.06}, {0.4, 0.11}, {0.3, 0.11}};
  block.mass_kg_m = 1.0;
  block.mass_end_kg_m = 20.0;
  block.mass_until_s = 0.2;
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 71, 31}, {rectangle("bed", 0, 0, 0.7, 0.06)}, {elastic(5e6, 0.3, 2000)});
  s.boundaries = {{"base", line({0, 0}, {0.7, 0}, "fixed")}};
  s.bodies = {{"block", block}};
  MpmOptions o = options({0, -9.81});
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(0.3, silent);
  const Vec2 before = solver.body_impulse(0);
  solver.advance_to(0.4, silent);
  const double force = (solver.body_impulse(0) - before).y() / 0.1;  // on the material: downwards
  EXPECT_NEAR(force, -20 * 9.81, 0.02 * 20 * 9.81);
  EXPECT_LT(std::abs(solver.body_displacement(0).x()), 1e-5);
}

}  // namespace
}  // namespace pivnp::mpm

// Block on a frictional plane inclined by t (gravity turned instead of the plane): slides with
// a = g (sin t - mu cos t), sticks where mu >= tan t. Criterion: acceleration within 2 %; a stuck block's mean
// displacement below 0.1 % of that of a free one. The stuck block starts in equilibrium: gravity switched on at once makes
// it bounce, and it slips while it is light.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/verification.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
double mean_displacement(double slope_deg, double friction, double time, bool in_equilibrium) {
  const double t = slope_deg * M_PI / 180;
  Scene s =
      scene(Grid{{0, 0}, {0.01, 0.01}, 81, 12}, {rectangle("block", 0.05, 0, 0.15, 0.05)}, {elastic(2e6, 0.2, 2000)});
  // With the stresses of the block's own weight it does not bounce.
  for (const Vec2& x : s.particles.x0) {
    const double across = -2000 * 9.81 * std::cos(t) * (0.05 - x.y());
    s.stress0.push_back({0.25 * across, across, 0.25 * across, 0});
  }
  s.boundaries = {{"plane", line({0, 0}, {0.8, 0}, "frictional", friction)}};
  Solver solver(options({9.81 * std::sin(t), -9.81 * std::cos(t)}), s, 1);
  if (in_equilibrium) solver.find_initial_equilibrium(silent);
  solver.advance_to(time, silent);
  const MotionFrame frame = solver.frame();
  double sum = 0;
  for (const auto& u : frame.u) sum += double(u[0]);
  const EnergyRow e = solver.energy();
  EXPECT_LT(std::abs(e.residual), 0.02 * e.external + 0.05 * e.elastic);
  return sum / double(frame.u.size());
}

TEST(MpmFriction, BlockSlidesOnAnIncline) {
  const double time = 0.3;
  for (const double friction : {0.0, 0.2, 0.4}) {
    const double t = 30 * M_PI / 180, exact = 0.5 * 9.81 * (std::sin(t) - friction * std::cos(t)) * time * time;
    const double found = mean_displacement(30, friction, time, false);
    std::printf("incline mu %.1f: displacement %+.2f %%\n", friction, 100 * (found / exact - 1));
    EXPECT_NEAR(found, exact, 0.02 * exact);
    pivnp::test::verification_row("block on an incline", "acceleration over g (sin t - mu cos t) within 2 %", number(found / exact, 4));
  }
}

TEST(MpmFriction, BlockSticksWhereFrictionSuffices) {
  const double found = mean_displacement(30, 0.65, 0.3, true), free = 0.25 * 9.81 * 0.09;
  std::printf("incline mu 0.65: displacement %.2e of a free block's\n", found / free);
  EXPECT_LT(std::abs(found), 1e-3 * free);
}

}  // namespace
}  // namespace pivnp::mpm

// Water as a material of its own, at length. Criteria: a lake of 1 m at rest for 60 s keeps the pressure of its depth, the mean of
// each row within 1 % of that of the floor, and no point moves by 1 % of the depth; the front of a dam break, of cells of H/40, lies
// within 1 % of the width and what it has run by another method with particles of H/400 (TrixiParticles.jl,
// validation_reference_wcsph_400.json: smoothed particles, water twice as wide as high). The energy guard is on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double weight = 1000 * 9.81;

Scene tank(double h, double width, double water_width) {
  MaterialOptions water;
  water.model = "water";
  water.density_kg_m3 = 1000;
  water.bulk_pa = 400 * weight;  // waves twenty times as fast as sqrt(g H)
  Scene s = scene(Grid{{0, 0}, {h, h}, int(std::lround(width / h)) + 1, int(std::lround(1.2 / h)) + 1}, {rectangle("water", 0, 0, water_width, 1)}, {water});
  s.boundaries = {{"floor", line({0, 0}, {width, 0}, "roller")},
                  {"left", line({0, 0}, {0, 1.2}, "roller")},
                  {"right", line({width, 0}, {width, 1.2}, "roller")}};
  return s;
}

MpmOptions filled() {
  MpmOptions o = options({0, -9.81});
  o.initial_equilibrium = false;
  o.k0 = 1.0;
  return o;
}

TEST(LakeAtRest, ForAMinute) {
  const Scene s = tank(0.1, 1, 1);
  Solver solver(filled(), s, 1);
  double drift = 0, moved = 0;
  for (double t = 5; t < 60.1; t += 5) {
    solver.advance_to(t, silent);
    const MotionFrame f = solver.frame();
    std::vector<double> off(10), n(10);
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const double y = s.particles.x0[k].y() + double(f.u[k][1]);
      const auto row = std::size_t(std::clamp(int(y * 10), 0, 9));
      off[row] += -0.5 * double(f.field("stress")(k, 0) + f.field("stress")(k, 1)) - weight * (1 - y);
      n[row] += 1;
      moved = std::max(moved, double(std::hypot(f.u[k][0], f.u[k][1])));
    }
    for (std::size_t row = 0; row < 10; ++row) drift = std::max(drift, std::abs(off[row] / n[row]) / weight);
  }
  pivnp::test::verification_row("a lake at rest for 60 s", "rows within 1 % of the floor's pressure, no point moved by 1 % of the depth",
           number(100 * drift) + " %, " + number(100 * moved) + " %");
  EXPECT_LT(drift, 0.01);
  EXPECT_LT(moved, 0.01);
  EXPECT_EQ(solver.ended(), 0u);
}

TEST(DamBreak, FollowsAnotherMethod) {
  const double h = 1.0 / 40;
  const Scene s = tank(h, 5.4, 2);
  Solver solver(filled(), s, 1);
  double worst = 0;
  for (const auto& [time, theirs] : std::vector<Pair>{{0.4, 0.216}, {0.8, 0.668}, {1.2, 1.256}, {1.6, 1.933}, {2.0, 2.667}}) {
    solver.advance_to(time / std::sqrt(9.81), silent);
    const MotionFrame f = solver.frame();
    double front = 0;
    for (std::size_t k = 0; k < f.u.size(); ++k) front = std::max(front, s.particles.x0[k].x() + double(f.u[k][0]));
    worst = std::max(worst, std::abs((front + 0.25 * h) / (2 + theirs) - 1));
  }
  pivnp::test::verification_row("dam break, front against smoothed particles of H/400", "1 %", number(100 * worst) + " %");
  EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace pivnp::mpm

// What transfers take out of a wave (docs/theory/mpm.md): APIC a share of each step, AFLIP a rate.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// A standing wave of a length of so many cells in a bar held at both ends: what is left of its energy, and the steps.
struct Left {
  double share, steps;
};
Left after_two_periods(double courant, TransferKind transfer, int cells = 20, double pic_per_s = 0) {
  const double h = 0.05, length = cells * h, speed = std::sqrt(1e6 / 1000), k = 2 * M_PI / length;
  Scene s = scene(Grid{{0, 0}, {h, h}, cells + 1, 3}, {rectangle("bar", 0, 0, length, 2 * h)}, {elastic(1e6, 0, 1000)});
  s.boundaries = {{"base", line({0, 0}, {length, 0}, "roller")},
                  {"left", line({0, 0}, {0, 2 * h}, "roller")},
                  {"right", line({length, 0}, {length, 2 * h}, "roller")}};
  for (const Vec2& x : s.particles.x0) {
    s.v0.emplace_back(1e-4 * std::sin(k * x.x()), 0);
    s.grad_v0.push_back({1e-4 * k * std::cos(k * x.x()), 0, 0, 0});
  }
  MpmOptions o = options();
  o.locking = Locking::none;
  o.transfer = transfer;
  if (pic_per_s > 0) o.pic_per_s = pic_per_s;
  o.courant = courant;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  solver.advance_to(2 * length / speed, silent);
  const EnergyRow end = solver.energy();
  return {(end.kinetic + end.elastic) / (start.kinetic + start.elastic), double(solver.steps())};
}

// In steps as short as these what the steps themselves change of the shown energy is small beside it (FLIP has that alone).
TEST(ApicLoss, IsThatOfItsFilterInEachStep) {
  const double q = 2 * M_PI / 20, per_step = std::pow(q, 4) / 40;
  for (const double courant : {0.1, 0.05}) {
    const Left left = after_two_periods(courant, TransferKind::apic);
    EXPECT_NEAR(-std::log(left.share) / left.steps / per_step, 1, 0.1) << courant;
  }
  EXPECT_NEAR(after_two_periods(0.05, TransferKind::flip).share, 1, 0.02);
}

// The share r dt of a step is that of a second, whatever the step; without it next to nothing is lost.
TEST(AflipLoss, IsARateThatKnowsNoStep) {
  const int cells = 10;
  const double q = 2 * M_PI / cells, seconds = 2 * cells * 0.05 / std::sqrt(1e6 / 1000), rate = 1500;
  const double lost = rate * std::pow(q, 4) / 40 * seconds;
  for (const double courant : {0.1, 0.05}) {
    EXPECT_NEAR(-std::log(after_two_periods(courant, TransferKind::aflip, cells, rate).share) / lost, 1, 0.15) << courant;
    EXPECT_NEAR(after_two_periods(courant, TransferKind::aflip, cells).share, 1, 0.02) << courant;
  }
}

}  // namespace
}  // namespace pivnp::mpm

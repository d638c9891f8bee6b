// Hourglass modes of bilinear elements: one-point integration ("full") does not resist them, the others do; the record
// says how much kinetic energy is in them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
constexpr double h = 0.1, speed = 1e-3, young = 1e6, density = 1000;

// A free block of 6 x 6 cells whose points move left and right by turns. A point halfway between a node and the
// cell's centre has 9/16 of its weight there and 3/16, 3/16, 1/16 elsewhere: a quarter of the points' speed reaches the
// nodes, as pure hourglass motion.
Solver checkered_block(const char* locking) {
  Scene s = scene(Grid{{0, 0}, {h, h}, 11, 11}, {rectangle("block", 2 * h, 2 * h, 8 * h, 8 * h)},
                  {elastic(young, 0.3, density)});
  for (const Vec2& x : s.particles.x0) {
    const int i = int(std::lround(x.x() / h)), j = int(std::lround(x.y() / h));
    s.v0.emplace_back((i + j) % 2 == 0 ? speed : -speed, 0);
  }
  MpmOptions o = conservative();
  o.locking = value_named<Locking>(locking);
  o.end_at_rest = false;
  return Solver(o, s, 1);
}

// Hourglass energy over the nodes' kinetic energy at the start: at first, and its least within the time that a wave
// takes across a dozen cells. (It is that of the last step's start.)
std::pair<double, double> first_and_least(const char* locking) {
  Solver solver = checkered_block(locking);
  const double nodal = solver.energy().kinetic / 16, wave = std::sqrt(1.346 * young / density);
  double first = 0, least = 1e9;
  for (int k = 1; k <= 48; ++k) {
    solver.advance_to(0.25 * k * h / wave, silent);
    const EnergyRow e = solver.energy();
    if (k == 1) first = e.hourglass / nodal;
    least = std::min(least, e.hourglass / nodal);
  }
  return {first, least};
}

TEST(Hourglass, OnePointIntegrationDoesNotResist) {
  const auto [first, least] = first_and_least("full");
  EXPECT_NEAR(first, 1, 1e-6);
  EXPECT_NEAR(least, 1, 1e-6);
}

TEST(Hourglass, IntegrationAtThePointsDoes) {
  for (const char* locking : {"none", "selective", "fbar"}) EXPECT_LT(first_and_least(locking).second, 0.2) << locking;
}

TEST(Hourglass, SplinesHaveNone) {
  Scene s = scene(Grid{{0, 0}, {h, h}, 11, 11}, {rectangle("block", 2 * h, 2 * h, 8 * h, 8 * h)},
                  {elastic(young, 0.3, density)});
  s.v0.assign(s.particles.size(), Vec2(speed, 0));
  Solver solver(options(), s, 1);
  solver.advance_to(1e-3, silent);
  EXPECT_EQ(solver.energy().hourglass, 0);
}

}  // namespace
}  // namespace pivnp::mpm

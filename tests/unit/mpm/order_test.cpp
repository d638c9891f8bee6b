// Order in the step of what changes with time: runs that start in equilibrium, with steps of two lengths against one
// whose steps are a tenth of the shorter, on the same cells, with FLIP (APIC takes a little energy at each step,
// whatever its length).
//
// Velocities live in the middle between two states. Loads, densities and boundaries are those of the state at a step's
// start, strengths those of the state that its stress is updated to. Each criterion lies between what that leaves and
// what the same input leaves a step or half a step to the side, which is of first order: a ratio of 2.0 to 2.1. (Runs
// end on time, with a step of another length, and MUSL smooths once a step: ratios are 2.3 to 2.9, not 4.)
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/silent.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double end_s = 0.0102;  // no whole number of steps

// Mean displacement along an axis.
double moved(const Scene& s, MpmOptions o, double courant, std::size_t axis) {
  o.courant = courant;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(end_s, silent);
  double sum = 0;
  for (const auto& u : solver.frame().u) sum += double(u[axis]);
  return sum / double(solver.particles().size());
}

struct Found {
  double coarse, ratio;  // relative error of the longer steps, and over that of the shorter
};
Found errors(const Scene& s, const MpmOptions& o, std::size_t axis = 1) {
  const double exact = moved(s, o, 0.02, axis), coarse = moved(s, o, 0.4, axis) - exact,
               fine = moved(s, o, 0.2, axis) - exact;
  const Found found{std::abs(coarse / exact), std::abs(coarse / fine)};
  std::printf("error %.2e with courant 0.4, %.2e with 0.2: ratio %.2f\n", found.coarse, std::abs(fine / exact),
              found.ratio);
  return found;
}

// A bar 0.1 high between rollers on a fixed base (waves cross it in .003 s).
Scene bar() { return column(0.1, elastic(1e6, 0.0, 1000)); }

TEST(Order, GravityThatRampsUp) {
  MpmOptions o = conservative({0, -20});
  o.gravity_from_m_s2 = Pair{0, 0};
  o.gravity_ramp_s = 0.012;
  const Found e = errors(bar(), o);
  EXPECT_LT(e.coarse, 3e-4);  // (to the side: 3.7e-3 in the middle of the step)
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, TractionThatRises) {
  Scene s = bar();
  s.boundaries.push_back({"load", line({0, 0.1}, {0.1, 0.1}, "traction")});
  s.boundaries.back().second.traction_pa = Pair{0, -2000};
  s.boundaries.back().second.rise_s = 0.012;
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 1e-4);  // (both are too small for a ratio)
}

TEST(Order, DensityThatRises) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.density_end_kg_m3 = 2000;
  m.density_until_s = 0.012;
  const Found e = errors(column(0.1, m), conservative({0, -20}));
  EXPECT_LT(e.coarse, 8e-4);  // (to the side: 1.7e-2)
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, BoundaryThatMoves) {
  Scene s = bar();
  s.boundaries[0].second.velocity_m_s = Pair{0, 0.05};
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 8e-4);
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, PlateThatMoves) {
  Scene s = scene(Grid{{0, 0}, {0.01, 0.01}, 11, 15}, {rectangle("soil", 0, 0, 0.1, 0.1)}, {elastic(1e6, 0.0, 1000)});
  s.boundaries = bar().boundaries;
  RigidOptions plate;
  plate.polygon_m = {{0, 0.1}, {0.1, 0.1}, {0.1, 0.13}, {0, 0.13}};
  plate.velocity_m_s = {0, -0.05};
  s.bodies = {{"plate", plate}};
  const Found e = errors(s, conservative());
  EXPECT_LT(e.coarse, 2e-3);
  EXPECT_GT(e.ratio, 2.25);
}

TEST(Order, StrengthThatFalls) {
  MaterialOptions m = elastic(1e6, 0.0, 1000);
  m.model = "tresca";
  m.shear_strength_pa = 1500;
  m.reduction_factor = 5;
  m.reduction_until_s = 0.012;
  const Found e = errors(column(0.1, m), conservative({0, -20}));
  EXPECT_LT(e.coarse, 8e-4);  // (to the side: 2.8e-2)
  EXPECT_GT(e.ratio, 2.25);
}

}  // namespace
}  // namespace pivnp::mpm

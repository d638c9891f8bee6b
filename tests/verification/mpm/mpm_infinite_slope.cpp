// An endless slope, gravity turned, between tied sides; strength reduced by R in time until it slides. On the fixed base
// it then accelerates with g sin b (1 - FS/R), so FS = R (1 - a/(g sin b)). Criterion: within 2 % of
// tan f/tan b + c/(rho g H sin b) for associated flow; without dilatancy the planes parallel to the slope, which neither
// lengthen nor open, carry tan f* = sin f instead (Davis 1968): within 2 % of that.
#include <gtest/gtest.h>

#include <cmath>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
constexpr double g = 9.81, height = 1.0, rho = 1600, slope = 20 * M_PI / 180;

double mean_velocity(const Solver& solver) {
  const MotionFrame frame = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < frame.v.size(); ++k) {
    if (solver.particles().x0[k].y() < 0.8 * height) continue;
    sum += double(frame.v[k][0]);
    ++n;
  }
  return sum / n;
}

// `exact`: the factor expected; found over it.
double safety(double dilatancy_deg, double cohesion_pa, int cells, double exact) {
  const double h = height / cells, reduction = 1.05 * exact;
  MaterialOptions m = sand(30, 2e7);
  m.dilatancy_deg = dilatancy_deg;
  m.cohesion_pa = cohesion_pa;
  m.reduction_factor = reduction;
  m.reduction_until_s = 0.5;
  Scene s = scene(Grid{{0, 0}, {h, h}, 5, cells + 4}, {rectangle("soil", 0, 0, 4 * h, height)}, {m});
  BoundaryOptions sides = line({0, 0}, {0, height + 2 * h}, "tied");
  sides.across_m = Pair{4 * h, 0};
  s.boundaries = {{"base", line({0, 0}, {4 * h, 0}, "fixed")}, {"sides", sides}};
  MpmOptions o = options({g * std::sin(slope), -g * std::cos(slope)});
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  solver.advance_to(0.9, silent);
  const double before = mean_velocity(solver);
  solver.advance_to(1.5, silent);
  EXPECT_EQ(solver.ended(), 0u);
  const double a = (mean_velocity(solver) - before) / 0.6, found = reduction * (1 - a / (g * std::sin(slope)));
  pivnp::test::verification_row("endless slope of 20 deg, friction 30 deg, dilatancy " + number(dilatancy_deg) +
                                    ", cohesion " + number(cohesion_pa) + " Pa, " + number(cells) + " cells high",
                                "factor of safety over the exact one within 2 %", number(found / exact, 4));
  return found / exact;
}

TEST(MpmInfiniteSlope, FactorOfSafety) {
  const double friction = std::tan(30 * M_PI / 180) / std::tan(slope);
  EXPECT_NEAR(safety(30, 0, 10, friction), 1, 0.02);
  EXPECT_NEAR(safety(30, 0, 20, friction), 1, 0.02);
  // The layer that shears is a cell or two thick: cohesion's part is as of a slope that is so much lower.
  EXPECT_NEAR(safety(30, 2000, 40, friction + 2000 / (rho * g * height * std::sin(slope))), 1, 0.02);
  // sin(friction, reduced) = tan(slope).
  EXPECT_NEAR(safety(0, 0, 20, std::tan(30 * M_PI / 180) / std::tan(std::asin(std::tan(slope)))), 1, 0.02);
}

}  // namespace
}  // namespace pivnp::mpm

// What must not change where a dry column comes to rest (Mohr-Coulomb, plane strain, no equilibrium sought, gate drawn at once):
// the time step, the elastic stiffness and the number of points. Dimensionless numbers:
// aspect a = H/d0, friction, E/(rho g H), cells over d0. Two lengths over d0: how far the outermost 5 % of the mass have come in the
// mean, and how far the whole has (spread).
// Criteria (a priori): Courant number 0.1 to 0.8 2 %, E x 0.3 to x 10 3 %, 4 to 16 points a cell 3 %. In small: 10 cells, where a
// particle is more of the whole: 4 %. (What finer cells change: docs/theory/mpm.md.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

struct ColumnRun {
  double aspect = 1.4, friction_deg = 34, base_friction = 0;  // 0: material sticks
  int cells = 10, points = 4;                                 // over d0; a cell
  double courant = 0.6, stiffness = 600;                      // E/(rho g H)
  const char* transfer = "aflip";
};
struct Reach {
  double front, spread;  // over d0
};

Reach reach_of(const ColumnRun& c) {
  const double d0 = 0.2, g = 9.81, h = d0 / c.cells;
  const int up = int(std::lround(c.aspect * c.cells));
  const int nx = int(std::ceil(c.cells * (c.aspect < 2.3 ? 1.8 + 2.8 * c.aspect : 1.8 + 4.2 * std::cbrt(c.aspect * c.aspect))));
  const double height = up * h;
  Scene s = scene(Grid{{0, 0}, {h, h}, nx + 1, up + 4}, {rectangle("sand", 0, 0, d0, height)},
                  {sand(c.friction_deg, c.stiffness * 1600 * g * height)}, c.points);
  s.boundaries = {{"base", line({0, 0}, {nx * h, 0}, c.base_friction > 0 ? "frictional" : "fixed", c.base_friction)},
                  {"wall", line({0, 0}, {0, (up + 3) * h}, "roller")}};
  MpmOptions o = options({0, -g});
  o.transfer = value_named<TransferKind>(c.transfer);
  o.courant = c.courant;
  o.initial_equilibrium = false;
  Solver solver(o, s, 1);
  solver.advance_to(6 * std::sqrt(height / g), silent);
  const MotionFrame frame = solver.frame();
  std::vector<double> x;
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    if (frame.status[k] != ParticleStatus::ended) x.push_back((s.particles.x0[k].x() + double(frame.u[k][0])) / d0);
  std::sort(x.begin(), x.end());
  const auto mean_from = [&](std::size_t first) {
    double sum = 0;
    for (std::size_t k = first; k < x.size(); ++k) sum += x[k];
    return sum / double(x.size() - first);
  };
  return {mean_from(x.size() - x.size() / 20) - 1, mean_from(0) - 0.5};
}

// Each run's lengths lie within `share` of their mean.
void expect_alike(const std::string& what, const std::vector<ColumnRun>& runs, double share) {
  std::vector<Reach> all;
  std::string fronts, spreads;
  for (const ColumnRun& run : runs) {
    all.push_back(reach_of(run));
    fronts += (fronts.empty() ? "" : ", ") + number(all.back().front, 4);
    spreads += (spreads.empty() ? "" : ", ") + number(all.back().spread, 4);
  }
  const auto off = [&](double Reach::*member) {
    const auto [least, most] = std::minmax_element(all.begin(), all.end(), [&](const Reach& a, const Reach& b) { return a.*member < b.*member; });
    return ((*most).*member - (*least).*member) / ((*most).*member + (*least).*member);
  };
  pivnp::test::verification_row("column's run-out, " + what, "run-out and spread of the mass within " + number(100 * share, 2) + " % of their mean",
                                "run-out " + fronts + " (" + number(100 * off(&Reach::front), 2) + " %), spread " + spreads + " (" +
                                    number(100 * off(&Reach::spread), 2) + " %)");
  EXPECT_LT(off(&Reach::front), share) << what;
  EXPECT_LT(off(&Reach::spread), share) << what;
}

// (APIC: 15 % with the step, 12 % with the stiffness.)
TEST(RunOutSmall, KnowsNeitherStepNorStiffnessNorPoints) {
  const double share = 0.04;
  expect_alike("Courant number 0.1, 0.3, 0.8", {{.courant = 0.1}, {.courant = 0.3}, {.courant = 0.8}}, share);
  expect_alike("E x 0.3, 1, 10", {{.stiffness = 200}, {}, {.stiffness = 6000}}, share);
  expect_alike("4, 9, 16 points a cell", {{.points = 4}, {.points = 9}, {.points = 16}}, share);
}

TEST(RunOut, KnowsNeitherStepNorStiffnessNorPoints) {
  for (const ColumnRun& column : {ColumnRun{.aspect = 0.8, .friction_deg = 24, .cells = 20}, ColumnRun{.aspect = 1.6, .friction_deg = 38, .base_friction = 0.5, .cells = 20},
                                  ColumnRun{.aspect = 3.5, .friction_deg = 30, .cells = 12}}) {
    const std::string of = "a " + number(column.aspect, 2) + ", " + number(column.friction_deg, 2) + " degrees, " +
                           (column.base_friction > 0 ? "base " + number(column.base_friction, 2) : std::string("rough base")) + ", ";
    const auto with = [&](auto ColumnRun::*member, auto value) {
      ColumnRun run = column;
      run.*member = value;
      return run;
    };
    expect_alike(of + "Courant number 0.1, 0.4, 0.8", {with(&ColumnRun::courant, 0.1), with(&ColumnRun::courant, 0.4), with(&ColumnRun::courant, 0.8)}, 0.02);
    expect_alike(of + "E x 0.3, 1, 10", {with(&ColumnRun::stiffness, 200.0), column, with(&ColumnRun::stiffness, 6000.0)}, 0.03);
    expect_alike(of + "4, 9, 16 points a cell", {column, with(&ColumnRun::points, 9), with(&ColumnRun::points, 16)}, 0.03);
  }
}

}  // namespace
}  // namespace pivnp::mpm

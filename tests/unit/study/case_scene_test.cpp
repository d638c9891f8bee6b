// What a case file asks of the simulation reaches it: reservoirs, quiet boundaries, excavation, strength that is
// reduced, contact, tied sides.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "apps/study/pipeline/scene/sizes.hpp"
#include "apps/study/studies/check.hpp"
#include "mpm/heat/heat.hpp"
#include "mpm/solver/solver.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {

std::unique_ptr<mpm::Solver> solver_of(const std::string& text) {
  const Case c = parse_case(text, "case.toml", ".");
  const Setting setting = make_setting(c, 0, 0);
  return std::make_unique<mpm::Solver>(*c.mpm, make_scene(c, setting, *c.mpm, c.materials, "material."), 1);
}

// `head` is followed by [mpm] with its own keys and what every case without frames needs.
std::string case_of(const std::string& head, const std::string& mpm, const std::string& boundaries) {
  return head + "[mpm]\nend_s = 1.0\noutput_rate_hz = 1.0\n" + mpm + boundaries;
}

/// Mean of a stress component over the particles of a box, at their first places.
double mean_stress(const mpm::Solver& solver, std::size_t component, Vec2 low, Vec2 high) {
  const MotionFrame frame = solver.frame();
  double sum = 0, n = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    const Vec2& x = solver.particles().x0[k];
    if (x.x() < low.x() || x.y() < low.y() || x.x() > high.x() || x.y() > high.y()) continue;
    sum += double(frame.field("stress")(k, component));
    ++n;
  }
  EXPECT_GT(n, 0);
  return sum / n;
}

double farthest(const mpm::Solver& solver) {
  double most = 0;
  for (const auto& u : solver.frame().u) most = std::max(most, std::hypot(double(u[0]), double(u[1])));
  return most;
}

// The steps told of before a run are those of the mixture, water included, or of the skeleton where pressure is projected; where the run
// decides, at most the former.
TEST(CaseScene, TheSizeCountsTheStepsThatWaterAsksFor) {
  const auto sample = [](const std::string& scheme) {
    return parse_case(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.04, 0.12]]
[region.sample]
polygon_m = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.1], [0.0, 0.1]]
[material.sample]
model = "linear_elastic"
young_pa = 10e6
porosity = 0.3
permeability_m_s = 1e-5
grain_density_kg_m3 = 2650.0
[water]
)", "gravity_m_s2 = [0.0, 0.0]\ninitial_equilibrium = false\n" + scheme, ""), "case.toml", ".");
  };
  double counted[2];
  for (const bool projected : {false, true}) {
    const Case c = sample(projected ? "pressure = \"projected\"\n" : "pressure = \"explicit\"\n");
    const Setting setting = make_setting(c, 0, 0);
    const double step = make_solver(c, setting, 1).stable_step();
    const CaseSize size = size_of(c, setting, 0, 1);
    counted[projected] = size.steps;
    EXPECT_NEAR(size.steps, 1 / step, 1e-6 / step) << projected;
    EXPECT_FALSE(size.steps_at_most);
  }
  EXPECT_GT(counted[0], 10 * counted[1]);
  const Case open = sample("");
  const CaseSize size = size_of(open, make_setting(open, 0, 0), 0, 1);
  EXPECT_TRUE(size.steps_at_most);
  EXPECT_DOUBLE_EQ(size.steps, counted[0]);
}

// Every point of a material with bands may come to have one: that is counted, of its regions alone.
TEST(CaseScene, MemoryCountsTheBandsThatPointsMayHave) {
  const auto memory = [](const std::string& band) {
    const Case c = parse_case(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [4.0, 2.0]]
[region.clay]
polygon_m = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.5], [0.0, 0.5]]
[region.above]
polygon_m = [[0.0, 0.5], [4.0, 0.5], [4.0, 1.0], [0.0, 1.0]]
material = "rock"
[material.rock]
model = "linear_elastic"
young_pa = 10e6
density_kg_m3 = 2000.0
[material.clay]
model = "mohr_coulomb"
young_pa = 10e6
density_kg_m3 = 2000.0
friction_deg = 20.0
)" + band + "[heat]\n", "", ""), "case.toml", ".");
    return size_of(c, make_setting(c, 0, 0), 0, 1).memory_bytes;
  };
  const double points = 4 * 400 * 100, of_clay = points / 2;
  const double without = memory(""), with = memory("band_thickness_m = 0.001\n");
  EXPECT_GE(with - without, of_clay * sizeof(mpm::ShearBand) + points * sizeof(mpm::Turning));
  EXPECT_LE(with - without, of_clay * sizeof(mpm::ShearBand) + points * (sizeof(mpm::Turning) + 64));
}

// Chapter 5: a reservoir as a nearly shear-free elastic body that presses on the bank it stands against, at the start
// and while things move.
TEST(CaseScene, AReservoirPressesOnItsBank) {
  const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.05
area_m = [[0.0, 0.0], [1.0, 0.5]]
[region.bank]
polygon_m = [[0.0, 0.0], [0.8, 0.0], [0.0, 0.4]]
[region.reservoir]
polygon_m = [[0.8, 0.0], [1.0, 0.0], [1.0, 0.3], [0.2, 0.3]]
material = "water"
[material.bank]
model = "linear_elastic"
density_kg_m3 = 1600.0
young_pa = 5e6
[material.water]
model = "water"
density_kg_m3 = 1000.0
bulk_pa = 2e6
)",
                                        "", R"(
[boundary.base]
line_m = [[0.0, 0.0], [1.0, 0.0]]
type = "roller"
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.5]]
type = "roller"
[boundary.right]
line_m = [[1.0, 0.0], [1.0, 0.5]]
type = "roller"
)"));
  solver->find_initial_equilibrium(silent);
  for (const double until : {0.0, 0.2}) {
    solver->advance_to(until, silent);
    const double weight = 1000 * 9.81;
    for (const double y : {0.05, 0.15}) {
      const Vec2 low(0.85, y), high(1.0, y + 0.05);
      const double xx = mean_stress(*solver, 0, low, high), yy = mean_stress(*solver, 1, low, high);
      EXPECT_NEAR(yy, -weight * (0.3 - y - 0.025), 0.03 * weight * 0.3) << until;
      EXPECT_NEAR(xx, yy, 0.01 * weight * 0.3) << until;
    }
    // Under half a bank's and half a reservoir's height.
    const double carried = mean_stress(*solver, 1, {0.45, 0}, {0.55, 0.05});
    EXPECT_NEAR(carried, -9.81 * (1600 * 0.125 + 1000 * 0.15), 0.1 * 9.81 * 350) << until;
    EXPECT_LT(farthest(*solver), 0.002) << until;
  }
  EXPECT_EQ(solver->ended(), 0u);
}

// A bar pushed at one end: a quiet far end lets the wave go, a fixed one doubles it.
TEST(CaseScene, AQuietBoundaryLetsAPushGo) {
  const auto at_the_end = [](const std::string& type) {
    const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [1.0, 0.05]]
[region.bar]
polygon_m = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.05], [0.0, 0.05]]
[material.bar]
model = "linear_elastic"
density_kg_m3 = 1000.0
young_pa = 1e6
poisson = 0.0
)",
                                          "gravity_m_s2 = [0.0, 0.0]\n", R"(
[boundary.low]
line_m = [[0.0, 0.0], [1.0, 0.0]]
type = "roller"
[boundary.high]
line_m = [[0.0, 0.05], [1.0, 0.05]]
type = "roller"
[boundary.push]
line_m = [[0.0, 0.0], [0.0, 0.05]]
type = "traction"
traction_pa = [1000.0, 0.0]
rise_s = 0.01
[boundary.far]
line_m = [[1.0, 0.0], [1.0, 0.05]]
type = ")" + type + "\"\n"));
    solver->advance_to(1.7 / std::sqrt(1000.0), silent);  // there at 1.3 L/c with all of its rise, back at 2 L/c
    return mean_stress(*solver, 0, {0.9, 0}, {0.97, 0.05});
  };
  EXPECT_NEAR(at_the_end("absorbing"), -1000, 30);
  EXPECT_NEAR(at_the_end("fixed"), -2000, 60);
}

TEST(CaseScene, AnExcavationGoesStageByStage) {
  const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.1, 0.4]]
[region.below]
polygon_m = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
[region.second]
polygon_m = [[0.0, 0.1], [0.1, 0.1], [0.1, 0.2], [0.0, 0.2]]
[region.first]
polygon_m = [[0.0, 0.2], [0.1, 0.2], [0.1, 0.3], [0.0, 0.3]]
[material.below]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
[material.second]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
removed_s = 0.2
[material.first]
model = "linear_elastic"
density_kg_m3 = 1500.0
young_pa = 1e6
removed_s = 0.1
)",
                                        "damping = 0.6\n", R"(
[boundary.base]
line_m = [[0.0, 0.0], [0.1, 0.0]]
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.4]]
type = "roller"
[boundary.right]
line_m = [[0.1, 0.0], [0.1, 0.4]]
type = "roller"
)"));
  solver->find_initial_equilibrium(silent);
  const std::size_t stage = solver->particles().size() / 3;
  for (int stages = 0; stages < 3; ++stages) {
    solver->advance_to(0.095 + 0.1 * stages, silent);
    EXPECT_EQ(solver->ended(), std::size_t(stages) * stage);
    const double weight = 1500 * 9.81 * 0.1;
    EXPECT_NEAR(mean_stress(*solver, 1, {0, 0}, {0.1, 0.1}), -weight * (2.5 - stages), 0.05 * weight) << stages;
  }
}

// A vertical cut in clay with gamma H/c = 2 stands; with a third of the strength it cannot (limits: 3.8).
TEST(CaseScene, ACutFailsWhenItsStrengthIsReduced) {
  const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.8, 0.24]]
[region.clay]
polygon_m = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.2], [0.0, 0.2]]
[material.clay]
model = "tresca"
density_kg_m3 = 2000.0
young_pa = 2e6
shear_strength_pa = 2000.0
reduction_factor = 3.0
reduction_from_s = 0.1
)",
                                        "", R"(
[boundary.base]
line_m = [[0.0, 0.0], [0.8, 0.0]]
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.24]]
type = "roller"
)"));
  solver->find_initial_equilibrium(silent);
  solver->advance_to(0.1, silent);
  EXPECT_LT(farthest(*solver), 1e-3);
  solver->advance_to(0.3, silent);
  EXPECT_GT(farthest(*solver), 0.02);
}

// A block on a slope of 30 degrees slides with its friction where the case names a contact, and sticks where it does
// not.
TEST(CaseScene, AContactLetsABlockSlide) {
  const auto moved = [](const std::string& contact) {
    const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.3, 0.12]]
[region.bed]
polygon_m = [[0.0, 0.0], [0.3, 0.0], [0.3, 0.04], [0.0, 0.04]]
[region.block]
polygon_m = [[0.05, 0.04], [0.15, 0.04], [0.15, 0.08], [0.05, 0.08]]
[material.bed]
model = "linear_elastic"
density_kg_m3 = 2000.0
young_pa = 5e6
[material.block]
model = "linear_elastic"
density_kg_m3 = 2000.0
young_pa = 2e6
poisson = 0.2
)",
                                          "gravity_m_s2 = [4.905, -8.4957]\nsettle = false\n",
                                          "[boundary.base]\nline_m = [[0.0, 0.0], [0.3, 0.0]]\n" + contact));
    solver->advance_to(0.15, silent);
    const MotionFrame frame = solver->frame();
    double sum = 0, n = 0;
    for (std::size_t k = 0; k < frame.u.size(); ++k)
      if (solver->particles().label[k] == 1) sum += double(frame.u[k][0]), ++n;
    return sum / n;
  };
  const double exact = 0.5 * (4.905 - 0.2 * 8.4957) * 0.15 * 0.15;
  EXPECT_NEAR(moved("[contact.face]\nregions = [\"block\"]\nfriction = 0.2\n"), exact, 0.05 * exact);
  EXPECT_NEAR(moved("[contact.face]\nregions = [\"block\"]\nagainst = [\"bed\"]\nfriction = 0.2\n"), exact,
              0.05 * exact);
  EXPECT_LT(moved(""), 0.05 * exact);
}

TEST(CaseScene, TiedSidesAreAPieceOfAnEndlessSlope) {
  const auto solver = solver_of(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.04, 0.13]]
[region.soil]
polygon_m = [[0.0, 0.0], [0.04, 0.0], [0.04, 0.1], [0.0, 0.1]]
[material.soil]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 5e6
friction_deg = 30.0
)",
                                        "gravity_m_s2 = [3.0, -9.0]\n", R"(
[boundary.base]
line_m = [[0.0, 0.0], [0.04, 0.0]]
[boundary.sides]
line_m = [[0.0, 0.0], [0.0, 0.12]]
type = "tied"
across_m = [0.04, 0.0]
)"));
  solver->find_initial_equilibrium(silent);
  const double depth = 0.05, weight = 1600 * depth;
  EXPECT_NEAR(mean_stress(*solver, 3, {0, 0}, {0.04, 0.1}), 3.0 * weight, 0.02 * 3.0 * weight);
  EXPECT_NEAR(mean_stress(*solver, 1, {0, 0}, {0.04, 0.1}), -9.0 * weight, 0.02 * 9.0 * weight);
}

// `pivnp check` tells what the solver would refuse, also where there are no frames to draw on; one line with the file.
TEST(CaseScene, CheckRefusesWhatTheSolverWould) {
  const auto message = [](const std::string& tables, const std::string& mpm = "") -> std::string {
    Case c = parse_case(case_of(R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.2, 0.12]]
[region.bed]
polygon_m = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.04], [0.0, 0.04]]
[region.block]
polygon_m = [[0.05, 0.04], [0.15, 0.04], [0.15, 0.08], [0.05, 0.08]]
material = "bed"
[material.bed]
model = "linear_elastic"
density_kg_m3 = 2000.0
young_pa = 5e6
[boundary.base]
line_m = [[0.0, 0.0], [0.2, 0.0]]
)",
                                mpm, tables),
                        "case.toml", ".");
    c.file = "case.toml";
    try {
      check_case(c, {}, silent);
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  };
  const auto expect = [](const std::string& found, const std::string& text) {
    EXPECT_EQ(found.rfind("case.toml:", 0), 0u) << found;
    EXPECT_NE(found.find(": " + text), std::string::npos) << found;
  };
  EXPECT_EQ(message("[contact.face]\nregions = [\"block\"]\n"), "");
  expect(message("[contact.face]\nregions = [\"block\"]\nagainst = [\"block\"]\n"),
         "contact.face.against: found 'block'");
  expect(message("[contact.face]\nregions = [\"block\", \"bed\"]\n"), "contact.face.regions: there is no other region");
  expect(message("[contact.face]\nregions = [\"block\"]\n", "sleep_below_m_s = 0.01\n"),
         "mpm.sleep_below_m_s: given beside");
  expect(message("[boundary.sides]\nline_m = [[0.0, 0.0], [0.0, 0.1]]\ntype = \"tied\"\n"),
         "boundary.sides.across_m: missing");
}

}  // namespace
}  // namespace pivnp::app

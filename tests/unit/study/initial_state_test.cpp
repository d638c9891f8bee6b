// [initial.REGION]: the velocity and the stress that a simulation starts with.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "mpm/solver/solver.hpp"
#include "pivnp/core/error.hpp"
#include "tests/support/scratch.hpp"
#include "tests/support/silent.hpp"

namespace pivnp::app {
namespace {
namespace initial_state {

std::string case_of(const std::string& mpm, const std::string& more, const std::string& model = "linear_elastic") {
  return R"(
[grid]
spacing_m = 0.01
area_m = [[0.0, 0.0], [0.3, 0.2]]
[region.soil]
polygon_m = [[0.0, 0.0], [0.1, 0.0], [0.1, 0.1], [0.0, 0.1]]
[region.block]
polygon_m = [[0.15, 0.05], [0.25, 0.05], [0.25, 0.15], [0.15, 0.15]]
material = "soil"
[material.soil]
model = ")" + model + R"("
density_kg_m3 = 2000.0
young_pa = 5e6
[mpm]
end_s = 1.0
output_rate_hz = 1.0
)" + mpm + R"(
[boundary.base]
line_m = [[0.0, 0.0], [0.1, 0.0]]
type = "roller"
[boundary.left]
line_m = [[0.0, 0.0], [0.0, 0.2]]
type = "roller"
[boundary.right]
line_m = [[0.1, 0.0], [0.1, 0.12]]
type = "roller"
)" + more;
}

mpm::Solver solver_of(const std::string& text, const std::filesystem::path& folder = ".") {
  Case c = parse_case(text, "case.toml", folder);
  c.file = "case.toml";
  return make_solver(c, make_setting(c, 0, 0), 1);
}

std::string refusal_of(const std::string& text, const std::filesystem::path& folder = ".") {
  try {
    solver_of(text, folder);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

constexpr const char* without = "gravity_m_s2 = [0.0, 0.0]\ninitial_equilibrium = false\n";

TEST(InitialState, ABlockStartsWithItsVelocityAndSpin) {
  const mpm::Solver solver = solver_of(case_of(without, "[initial.block]\nvelocity_m_s = [1.5, -0.5]\nspin_rad_s = 4.0\n"));
  const MotionFrame frame = solver.frame();
  std::size_t turning = 0;
  for (std::size_t k = 0; k < frame.v.size(); ++k) {
    const Vec2 arm = solver.particles().x0[k] - Vec2(0.2, 0.1);
    const bool of_block = solver.particles().label[k] == 1;
    EXPECT_NEAR(frame.v[k][0], of_block ? 1.5 - 4 * arm.y() : 0, 1e-6);
    EXPECT_NEAR(frame.v[k][1], of_block ? -0.5 + 4 * arm.x() : 0, 1e-6);
    turning += of_block;
  }
  EXPECT_EQ(turning, 400u);
}

TEST(InitialState, StressIsThatOfTheHeight) {
  const mpm::Solver solver = solver_of(case_of(
      without, "[initial.soil]\nstress_pa = [-500.0, -1000.0, -700.0, 20.0]\nstress_gradient_pa_m = [5e3, 1e4, 7e3, 0.0]\nstress_level_m = 0.1\n"));
  const MotionFrame frame = solver.frame();
  const double at_level[4] = {-500, -1000, -700, 20}, gradient[4] = {5e3, 1e4, 7e3, 0};
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    for (std::size_t c = 0; c < 4; ++c) {
      const double expected = solver.particles().label[k] == 1 ? 0 : at_level[c] + gradient[c] * (solver.particles().x0[k].y() - 0.1);
      EXPECT_NEAR(frame.field("stress")(k, c), expected, 1e-3) << k << ' ' << c;
    }
}

// The equilibrium is sought from there: an overconsolidated layer keeps its horizontal stress, and carries its weight.
TEST(InitialState, AnEquilibriumIsSoughtFromThere) {
  const std::string layer = "[initial.soil]\nstress_pa = [-3000.0, 0.0, -3000.0, 0.0]\nstress_level_m = 0.1\n";
  std::string text = case_of("", layer);
  text.replace(text.find("[region.block]"), text.find("[material.soil]") - text.find("[region.block]"), "");
  mpm::Solver solver = solver_of(text);
  solver.find_initial_equilibrium(silent);
  const MotionFrame frame = solver.frame();
  double across = 0, down = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    across += double(frame.field("stress")(k, 0)) / double(frame.u.size());
    down += double(frame.field("stress")(k, 1)) / double(frame.u.size());
  }
  const double weight = 2000 * 9.81 * 0.05;
  EXPECT_NEAR(down, -weight, 0.01 * weight);
  // The weight itself comes on elastically: nu/(1 - nu) of it across.
  EXPECT_NEAR(across, -3000 - 0.3 / 0.7 * weight, 0.02 * 3000);
}

TEST(InitialState, AFilesStressIsLinearBetweenItsPoints) {
  const test::Scratch folder("initial_state");
  std::ofstream(folder.path / "stress.csv") << "# of a finite element program\n"
                                       "y_m;x_m;name;stress_xx_pa;stress_yy_pa;stress_zz_pa;stress_xy_pa\n"
                                       "0;0;a;-100;-200;-50;0\n0;0.1;b;-200;-200;-50;0\n0.1;0;c;-100;0;-50;10\n0.1;0.1;d;-200;0;-50;10\n";
  const std::string text = case_of(without, "[initial.soil]\nstress_file = \"stress.csv\"\n");
  const mpm::Solver solver = solver_of(text, folder.path);
  const MotionFrame frame = solver.frame();
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    if (solver.particles().label[k] == 1) continue;
    const Vec2& x = solver.particles().x0[k];
    const double expected[4] = {-100 - 1000 * x.x(), -200 + 2000 * x.y(), -50, 100 * x.y()};
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(frame.field("stress")(k, c), expected[c], 1e-3);
  }
  EXPECT_NE(refusal_of(case_of(without, "[initial.block]\nstress_file = \"stress.csv\"\n"), folder.path)
                .find("case.toml: initial.block.stress_file: no value within 0.1 m of the material point at ("),
            std::string::npos);
  std::ofstream(folder.path / "short.csv") << "x_m,y_m,stress_xx_pa,stress_yy_pa,stress_zz_pa\n";
  EXPECT_NE(refusal_of(case_of(without, "[initial.soil]\nstress_file = \"short.csv\"\n"), folder.path)
                .find("short.csv:1: no column 'stress_xy_pa'"),
            std::string::npos);
  std::ofstream(folder.path / "hole.csv") << "x_m,y_m,stress_xx_pa,stress_yy_pa,stress_zz_pa,stress_xy_pa\n0,0,,1,1,1\n";
  EXPECT_NE(refusal_of(case_of(without, "[initial.soil]\nstress_file = \"hole.csv\"\n"), folder.path)
                .find("hole.csv:2: column 'stress_xx_pa': found none, expected a number"),
            std::string::npos);
}

std::string wet_case_of(const std::string& more, const std::string& water = "") {
  std::string text = case_of(without, more);
  text.insert(
      text.find("[mpm]"),
      "porosity = 0.4\npermeability_m_s = 1e-6\ngrain_density_kg_m3 = 2650.0\n[water]\nbulk_modulus_pa = 2e7\n" +
          water);
  text.erase(text.find("density_kg_m3 = 2000.0"), std::string("density_kg_m3 = 2000.0\n").size());
  return text;
}

// Of one region by numbers, of the other by a file; without either it is zero.
TEST(InitialState, PressureIsThatOfTheHeightOrOfAFile) {
  const test::Scratch folder("initial_pressure");
  std::ofstream(folder.path / "pressure.csv")
      << "x_m,y_m,pressure_pa\n0.15,0.05,300\n0.25,0.05,800\n0.15,0.15,300\n0.25,0.15,800\n";
  const std::string numbers =
      "[initial.soil]\npressure_pa = 500.0\npressure_gradient_pa_m = -4e3\npressure_level_m = 0.1\n";
  for (const bool by_file : {false, true}) {
    const mpm::Solver solver = solver_of(
        wet_case_of(numbers + (by_file ? "[initial.block]\npressure_file = \"pressure.csv\"\n" : "")), folder.path);
    const MotionFrame frame = solver.frame();
    for (std::size_t k = 0; k < frame.u.size(); ++k) {
      const Vec2& x = solver.particles().x0[k];
      const double of_block = by_file ? 300 + 5000 * (x.x() - 0.15) : 0;
      EXPECT_NEAR(frame.field("pressure")(k, 0),
                  solver.particles().label[k] == 1 ? of_block : 500 - 4e3 * (x.y() - 0.1), 1e-2)
          << k;
    }
  }
}

// Such pressures stay while the equilibrium is sought, which needs them in all pores, or a level: in water that rises
// the skeleton bears less than its weight under water.
TEST(InitialState, AnEquilibriumIsSoughtUnderPressuresThatAreGiven) {
  std::string text = wet_case_of("[initial.soil]\npressure_pa = 1500.0\npressure_gradient_pa_m = -15e3\n");
  text.replace(text.find(without), std::string(without).size(), "gravity_m_s2 = [0.0, -9.81]\n");
  EXPECT_NE(refusal_of(text).find("water.level_m: missing beside mpm.initial_equilibrium"), std::string::npos)
      << refusal_of(text);
  text.replace(text.find("[region.block]"), text.find("[material.soil]") - text.find("[region.block]"), "");
  mpm::Solver solver = solver_of(text);
  solver.find_initial_equilibrium(silent);
  const MotionFrame frame = solver.frame();
  double down = 0;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    down += double(frame.field("stress")(k, 1)) / double(frame.u.size());
    EXPECT_NEAR(frame.field("pressure")(k, 0), 1500 - 15e3 * solver.particles().x0[k].y(), 1);
  }
  const double weight = (0.6 * 2650 + 0.4 * 1000) * 9.81 * 0.05;
  EXPECT_NEAR(down, 750 - weight, 0.01 * weight);
}

// A pressure that is given flows from the first step on, and is in the books.
TEST(InitialState, APressureThatIsGivenDissipates) {
  mpm::Solver solver = solver_of(wet_case_of("[initial.soil]\npressure_pa = 1e3\n"));
  const double start = solver.energy().water;
  EXPECT_NEAR(start, 0.01 * 0.4 * 1e6 / (2 * 2e7), 1e-3 * start);
  solver.advance_to(0.01, silent);
  EXPECT_LT(solver.energy().water, 0.5 * start);
  EXPECT_LT(std::abs(solver.energy().residual), 0.1 * start);  // (the layer that drains is thinner than a cell)
}

TEST(InitialState, WhatDoesNotFitIsRefused) {
  const auto expect = [](const std::string& more, const std::string& text, const std::string& mpm = without, const std::string& model = "linear_elastic") {
    const std::string found = refusal_of(case_of(mpm, more, model));
    EXPECT_NE(found.find(text), std::string::npos) << found;
    EXPECT_EQ(found.find('\n'), std::string::npos);
  };
  expect("[initial.blok]\nspin_rad_s = 1.0\n", "[initial.blok]: there is no [region.blok]; did you mean 'block'?");
  expect("[initial.soil]\nstress_pa = [1.0, 2.0]\n", "initial.soil.stress_pa: found 2 numbers, expected 4: xx yy zz xy");
  expect("[initial.soil]\nstress_gradient_pa_m = [1.0, 2.0, 3.0, 4.0]\n", "initial.soil.stress_gradient_pa_m: given without stress_pa, expected both or neither");
  expect("[initial.soil]\nstress_pa = [1.0, 2.0, 3.0, 4.0]\nstress_file = \"a.csv\"\n", "initial.soil.stress_file: given together with stress_pa, expected one of them");
  expect("[initial.soil]\nstress_pa = [1.0, 2.0, 3.0, 4.0]\n", "mpm.k0: given together with a stress of [initial.soil], expected one of them",
         "gravity_m_s2 = [0.0, -9.81]\nk0 = 0.5\n");
  expect("[initial.soil]\nstress_file = \"nothing.csv\"\n", "nothing.csv");
  expect("[initial.soil]\npressure_pa = 1.0\n", "initial.soil.pressure_pa: given without [water]");
  const auto expect_wet = [](const std::string& more, const std::string& text, const std::string& water = "") {
    const std::string found = refusal_of(wet_case_of(more, water));
    EXPECT_NE(found.find(text), std::string::npos) << found;
  };
  expect_wet("[initial.soil]\npressure_level_m = 0.1\n",
             "initial.soil.pressure_level_m: given without pressure_pa, expected both or neither");
  expect_wet("[initial.soil]\npressure_pa = 1.0\npressure_file = \"a.csv\"\n",
             "initial.soil.pressure_file: given together with pressure_pa, expected one of them");
  expect_wet("[initial.soil]\npressure_pa = -3e7\n",
             "initial.soil: a pressure of the pores is given below minus water.bulk_modulus_pa, expected more");
  expect_wet("[initial.soil]\npressure_pa = -1.0\n",
             "initial.soil: a pressure of the pores is given below zero beside water.groundwater",
             "level_m = 0.1\ngroundwater = \"level\"\n");
  expect("[initial.soil]\nstress_pa = [-1.0, -1.0, -1.0, 0.0]\n", "takes no stress at the start", without, "neo_hookean");
}

}  // namespace initial_state
}  // namespace
}  // namespace pivnp::app

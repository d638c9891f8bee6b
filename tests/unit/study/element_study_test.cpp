// Element tests of a case's material: what is written, what is said, what is refused.
#include "apps/study/element/element.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "pivnp/core/error.hpp"
#include "tests/support/scratch.hpp"

namespace pivnp::app {

namespace element_study_test {

using testing::HasSubstr;

constexpr const char* two_soils = R"(
[grid]
spacing_m = 0.1
area_m = [[0.0, 0.0], [0.6, 1.0]]
[region.sand]
polygon_m = [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4], [0.2, 0.4]]
[material.sand]
model = "mohr_coulomb"
density_kg_m3 = 1600.0
young_pa = 20e6
friction_deg = 35.0
[region.clay]
polygon_m = [[0.2, 0.4], [0.4, 0.4], [0.4, 0.6], [0.2, 0.6]]
[material.clay]
model = "tresca"
density_kg_m3 = 1700.0
young_pa = 5e6
poisson = 0.49
shear_strength_pa = 12e3
[mpm]
gravity_m_s2 = [0.0, -9.81]
end_s = 0.1
output_rate_hz = 50.0
)";

std::string error_of(const Case& c, const ElementStudy& study, const std::filesystem::path& out) {
  try {
    RunSettings settings;
    settings.out = out;
    element(c, study, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ElementCommand, SaysTheStrengthAndWritesEveryStep) {
  const test::Scratch scratch;
  const Case c = parse_case(two_soils, "two_soils", scratch.path);
  ElementStudy study;
  study.material = "sand";
  study.pressures_pa = {30e3, 90e3};
  study.laboratory = scratch.path / "lab.csv";
  std::ofstream(study.laboratory) << "axial_strain_percent,deviator_stress_kpa\n0,0\n1,60\n2,81\n";
  RunSettings settings;
  settings.out = scratch.path / "element";
  const ElementOutcome outcome = element(c, study, settings);
  EXPECT_THAT(outcome.sentences.back(), HasSubstr("friction angle 35 degrees"));
  for (const char* file : {"element.html", "element.pdf", "element.png", "element.svg", "element.csv", "element.h5"})
    EXPECT_TRUE(std::filesystem::exists(settings.out / file)) << file;
  study.test.strain = 1e-3;  // short of the strength
  EXPECT_THAT(element(c, study, settings).sentences.back(), HasSubstr("Not every test reached its peak"));
  study.test.strain = 0.2;
  element(c, study, settings);
  std::ifstream in(settings.out / "element.csv");
  std::string head, line;
  std::getline(in, head);
  EXPECT_EQ(head.substr(0, 60), std::string("pressure_pa,axial_strain_1,volumetric_strain_1,vertical_stress_pa").substr(0, 60));
  std::size_t rows = 0;
  while (std::getline(in, line)) ++rows;
  EXPECT_EQ(rows, outcome.paths[0].size() + outcome.paths[1].size());
}

TEST(ElementCommand, RefusesInOneLine) {
  const test::Scratch scratch;
  const Case c = parse_case(two_soils, "two_soils", scratch.path);
  const std::filesystem::path out = scratch.path / "element";
  ElementStudy study;
  EXPECT_THAT(error_of(c, study, out), HasSubstr("--material: missing, expected one of sand, clay"));
  study.material = "snad";
  EXPECT_THAT(error_of(c, study, out), HasSubstr("did you mean 'sand'?"));
  study.material = "clay";
  study.laboratory = scratch.path / "lab.csv";
  std::ofstream(study.laboratory) << "axial_strain_percent,q_kpa\n0,0\n1,60\n";
  EXPECT_THAT(error_of(c, study, out), HasSubstr("lab.csv:1: found a column 'q_kpa'"));
  study.laboratory.clear();
  study.pressures_pa = {1, 2, 3, 4, 5, 6, 7};
  EXPECT_THAT(error_of(c, study, out), HasSubstr("--pressure: found 7 pressures"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace element_study_test

}  // namespace pivnp::app

// Lengths in another unit than the metre are read into metres.
#include <cmath>
#include <string>

#include "apps/case/lengths.hpp"
#include "tests/unit/case/case_text.hpp"

namespace pivnp::app {
namespace {

// A case whose lengths are those of metres times `per_metre`, as decimals.
std::string slope_in(const std::string& unit, double per_metre) {
  const auto L = [&](double metres) {
    std::string text = std::to_string(double(std::lround(metres * per_metre * 1e6)) / 1e6);
    return text;
  };
  const auto P = [&](double x, double y) { return "[" + L(x) + ", " + L(y) + "]"; };
  return "[frames]\npath = \"f/*.png\"\nrate_hz = 25.0\n[camera]\nmetres_per_pixel = " + L(0.00025) + "\nlength_unit = \"" + unit +
         "\"\n[grid]\nspacing_m = " + L(0.004) + "\n[region.clay]\npolygon_m = [" + P(0, 0) + ", " + P(0.3, 0) + ", " + P(0.3, 0.12) +
         "]\n[water]\nlevel_history = [[0.0, " + L(0.1) + "], [2.0, " + L(0.05) + "]]\nsurface_m = [" + P(0, 0.08) + ", " + P(0.3, 0.06) +
         "]\n[material.clay]\nmodel = \"mohr_coulomb\"\nporosity = 0.4\npermeability_m_s = 1e-6\nyoung_pa = 2e6\nfriction_deg = 28.0\n"
         "softening_shape = 3.0\nfriction_residual_deg = 20.0\nsoftening_length_m = " + L(0.006) +
         "\n[initial.clay]\nvelocity_m_s = [0.1, 0.0]\n[boundary.base]\nline_m = [" + P(0, 0) + ", " + P(0.3, 0) +
         "]\n[body.ball]\ncircle_m = [" + L(0.15) + ", " + L(0.2) + ", " + L(0.02) + "]\nvelocity_m_s = [0.0, -0.05]\n[compare]\nslope_base_m = " + L(0.002) +
         "\n[compare.limits]\ndisplacement_rms_m = " + L(0.003) + "\n[mpm]\nend_displacement_m = " + L(0.25) + "\n[report.line.a]\nfrom_m = " + P(0.1, 0.01) +
         "\nto_m = " + P(0.2, 0.02) + "\nfield = \"displacement_x\"\n";
}

TEST(Lengths, ACaseInAnotherUnitIsTheSameCaseToTheBit) {
  const std::string in_m = write_case(parse_case(slope_in("m", 1), "m", "."));
  EXPECT_EQ(write_case(parse_case(slope_in("mm", 1e3), "mm", ".")), in_m);
  EXPECT_EQ(write_case(parse_case(slope_in("cm", 1e2), "cm", ".")), in_m);
  EXPECT_EQ(write_case(parse_case(slope_in("um", 1e6), "um", ".")), in_m);
  const Case c = parse_case(slope_in("mm", 1e3), "mm", ".");
  EXPECT_EQ(c.camera.length_unit, "m");
  EXPECT_EQ(*c.camera.metres_per_pixel, 0.00025);
  EXPECT_EQ(c.water->level_history[1], (Pair{2.0, 0.05}));
  EXPECT_EQ(c.bodies[0].second.velocity_m_s[1], -0.05);  // its own unit
}

TEST(Lengths, KeysGivenBesideTheFileAreInItsUnit) {
  const Case c = parse_case(slope_in("mm", 1e3), "mm", ".", {"grid.spacing_m=8"});
  EXPECT_EQ(*c.grid.spacing_m, 0.008);
}

TEST(Lengths, DefaultsAreInMetres) {
  const Case c = parse_case("[camera]\nmetres_per_pixel = 0.1\nlength_unit = \"mm\"\n[frames]\npath = \"f\"\n", "mm", ".");
  EXPECT_EQ(c.compare.numerical_uncertainty_m, compare::CompareOptions{}.numerical_uncertainty_m);
}

TEST(Lengths, ASimulationRunsInMetres) {
  const std::string text = "[camera]\nlength_unit = \"ft\"\n[grid]\nspacing_m = 0.1\narea_m = [[0.0, 0.0], [1.0, 1.0]]\n[region.a]\npolygon_m = [[0.0, 0.0], "
                           "[0.5, 0.0], [0.5, 0.5]]\n[material.a]\nmodel = \"linear_elastic\"\nyoung_pa = 1e6\n[mpm]\nend_s = 1.0\noutput_rate_hz = 10.0\n";
  try {
    parse_case(text, "d", ".");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with("d:2: camera.length_unit: ")) << error.what();
  }
  // A length of the scene, and px, stay what they are where nothing is simulated.
  const Case scene = parse_case("[camera]\nmetres_per_pixel = 0.001\nlength_unit = \"D\"\n[frames]\npath = \"f\"\n", "d", ".");
  EXPECT_EQ(scene.camera.length_unit, "D");
  EXPECT_EQ(*scene.camera.metres_per_pixel, 0.001);
  const Case px = parse_case("[camera]\nlength_unit = \"mm\"\n[grid]\nspacing_m = 16.0\n[frames]\npath = \"f\"\n", "px", ".");
  EXPECT_EQ(*px.grid.spacing_m, 16.0);
}

}  // namespace
}  // namespace pivnp::app

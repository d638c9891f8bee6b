// The report's table of the simulation: what was chosen, in a paper's words, and nothing that the laws do not use.
#include <gtest/gtest.h>

#include <map>

#include "apps/study/pipeline/record/simulation_setup.hpp"

namespace pivnp::app {
namespace {

TEST(SimulationSetup, NamesWhatWasChosen) {
  const Case c = parse_case(R"(
[grid]
spacing_m = 0.02
area_m = [[0.0, 0.0], [0.6, 0.4]]
[region.fill]
polygon_m = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.2], [0.0, 0.2]]
[material.fill]
model = "mohr_coulomb"
density_kg_m3 = 1720.0
young_pa = 8e6
friction_deg = 36.5
[mpm]
per_element = 9
refine = 2
courant = 0.3
damping = 0.05
end_s = 1.0
output_rate_hz = 10.0
gravity_m_s2 = [0.0, -490.5]
[boundary.floor]
line_m = [[0.0, 0.0], [0.6, 0.0]]
type = "frictional"
friction = 0.35
[body.plate]
polygon_m = [[0.1, 0.2], [0.2, 0.2], [0.2, 0.24], [0.1, 0.24]]
velocity_m_s = [0.0, -0.01]
)",
                            "case", ".");
  std::map<std::string, std::string> rows;
  for (const auto& [what, how] : simulation_setup(c, 0.02, 1234)) rows[what] = how;
  EXPECT_EQ(rows["Material fill"].find("mohr coulomb; density 1720 kg/m^3; Young\u2019s modulus 8 MPa; friction 36.5 deg"), 0u) << rows["Material fill"];
  EXPECT_EQ(rows["Material fill"].find("reduction"), std::string::npos);
  EXPECT_EQ(rows["Cells and material points"], "0.01 m, 9 points a cell at the start, 1234 points in all");
  EXPECT_EQ(rows["Time step"], "Courant number 0.3");
  EXPECT_EQ(rows["Gravity"], "(0, -490.5) m/s^2");
  EXPECT_EQ(rows["Further"].find("damping 0.05"), 0u) << rows["Further"];
  EXPECT_EQ(rows["Boundary floor"], "frictional; line (0, 0) to (0.6, 0) m; friction 0.35");
  EXPECT_EQ(rows["Rigid body plate"], "polygon (0.1, 0.2), (0.2, 0.2), (0.2, 0.24), (0.1, 0.24) m; velocity (0, -0.01) m/s");
  EXPECT_FALSE(rows.contains("Water"));
  EXPECT_TRUE(simulation_setup(Case{}, 0.02, 0).empty());
}

}  // namespace
}  // namespace pivnp::app

// Pervious soil beside heat: the flow takes parts of a step.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using ::testing::HasSubstr;

// A warm column so pervious that the flow alone would ask for steps five times as short as the waves do: it takes parts
// of a step, and the column consolidates as in steps of the flow (mpm.pressure = "explicit"), and as Terzaghi's.
TEST(Heat, InPerviousSoilTheFlowTakesPartsOfAStep) {
  WaterColumn c;
  c.height = 0.1, c.cells = 8, c.bulk = 4e8, c.permeability = 1e-4, c.rise = 0.02;
  Scene s = scene_of(c);
  s.materials[0].grain_specific_heat_j_kg_k = 837;
  s.materials[0].conductivity_w_m_k = 1.4;
  s.heat.emplace();
  MpmOptions o = options_of(c);
  Solver explicitly(o, s, 1);
  o.pressure.reset();
  Solver in_parts(o, s, 1);
  EXPECT_THAT(in_parts.pressure_choice(), HasSubstr("in which it takes parts"));
  Scene printed = s;  // whose bands exchange once in a step
  printed.materials[0].model = "tresca";
  printed.materials[0].shear_strength_pa = 1e6;
  printed.materials[0].band_thickness_m = 0.01;
  EXPECT_THAT(Solver(o, printed, 1).pressure_choice(), HasSubstr("parts"));
  printed.materials[0].band_exchange = BandExchange::printed;
  EXPECT_THAT(Solver(o, printed, 1).pressure_choice(), ::testing::Not(HasSubstr("parts")));
  const EnergyRow start = in_parts.energy();
  for (const double T : {0.1, 0.3}) {
    Solver again(o, s, 2);
    again.load(in_parts.save());
    explicitly.advance_to(c.at(T), silent);
    in_parts.advance_to(c.at(T), silent);
    again.advance_to(c.at(T), silent);
    EXPECT_TRUE(in_parts.save() == again.save());
    const MotionFrame is = in_parts.frame(), should = explicitly.frame();
    for (std::size_t k = 0; k < is.u.size(); ++k) {
      const double p = double(is.field("pressure")(k, 0)), y = s.particles.x0[k].y();
      EXPECT_NEAR(p, double(should.field("pressure")(k, 0)), 0.005 * c.load) << T << ' ' << y;
      EXPECT_NEAR(p, c.undrained_share() * c.load * terzaghi(1 - y / c.height, T - 0.5 * c.rise), 0.02 * c.load)
          << T << ' ' << y;
    }
  }
  const EnergyRow end = in_parts.energy();
  EXPECT_LT(4 * in_parts.steps(), explicitly.steps());
  EXPECT_NEAR(end.darcy, explicitly.energy().darcy, 0.02 * end.darcy);
  EXPECT_LT(std::abs(end.residual), 2e-3 * end.external);
  EXPECT_NEAR(end.heat, start.heat + end.heat_made + end.heat_inflow, 1e-6 * end.heat_made);
  EXPECT_LT(std::abs(end.water_mass - start.water_mass - end.water_inflow), 1e-12 * start.water_mass);
}

}  // namespace
}  // namespace pivnp::mpm

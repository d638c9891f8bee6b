// The water's own inertia: steps, bits, and what it leaves alone. (Waves: tests/verification/mpm/mpm_biot.cpp.)
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/silent.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

TEST(PoreWater, BitsWithInertiaDoNotDependOnThreadsNorOnARestart) {
  WaterColumn c = small_column();
  c.permeability = 1e-2;
  c.load = 1e3;
  Scene s = scene_of(c);
  s.water->inertia = true;
  expect_same_bits(options_of(c), s);
}

// Consolidation knows nothing of it: the flow's inertia is gone by then.
TEST(PoreWater, ConsolidationIsTheSameWithInertia) {
  WaterColumn c = small_column();
  const auto pressure = [&](bool inertia) {
    Scene s = scene_of(c);
    s.water->inertia = inertia;
    Solver solver(options_of(c), s, 1);
    const EnergyRow start = solver.energy();
    solver.advance_to(c.at(0.3), silent);
    const EnergyRow end = solver.energy();
    EXPECT_LT(std::abs(end.water_mass - start.water_mass - end.water_inflow), 1e-12 * start.water_mass);
    EXPECT_LT(std::abs(end.residual), 0.05 * end.external);
    return double(solver.frame().field("pressure")(0, 0));
  };
  const double without = pressure(false);
  EXPECT_NEAR(pressure(true), without, 1e-3 * without);
}

// The same limit holds with the water's own inertia, which bounds what flows in a step.
TEST(PoreWater, StepsWithTheWatersInertiaAreBounded) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline})
    for (const double permeability : {1e-8, 1e-4, 1e-2, 1.0})
      for (const double young : {1e6, 1e9})
        for (const bool lid : {true, false}) {
          RandomBlock b{shape, TransferKind::apic, PressureScheme::in_steps, young, permeability};
          b.lid = lid;
          b.inertia = true;
          EXPECT_FALSE(grows_in(b, 0.95)) << name_of(shape) << " " << permeability << " " << young << " " << lid;
        }
}

}  // namespace
}  // namespace pivnp::mpm

// Water in the pores: how long a step is, and up to where it is bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "mpm/step/time_step.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
using ::testing::HasSubstr;

// The step is that of (dt/t_w)^2 + dt/t_d = 1.
TEST(PoreWater, TheStepIsThatOfWaveAndFlowTogether) {
  for (const double permeability : {1e-9, 1e-5, 1e-3}) {
    WaterColumn c = small_column();
    c.permeability = permeability;
    c.courant = 1;
    const Solver solver(options_of(c), scene_of(c), 1);
    const double h = c.spacing(), speed = std::sqrt((c.modulus() + c.bulk / c.porosity) / c.density());
    const double D = permeability * c.bulk / (1000 * 9.81 * c.porosity), dt = solver.stable_step();
    EXPECT_NEAR(std::pow(dt * speed / h, 2) + dt * 4 * D / (h * h), 1, 1e-6);
  }
}

// Projected: that of the skeleton's wave, whatever the permeability.
TEST(PoreWater, TheProjectedStepIsThatOfTheSkeleton) {
  for (const double permeability : {1e-9, 1e-3}) {
    WaterColumn c = small_column();
    c.permeability = permeability;
    c.pressure = PressureScheme::projected;
    const Solver solver(options_of(c), scene_of(c), 1);
    const double expected = c.courant * c.spacing() / std::sqrt(c.modulus() / c.density()) * projected_step_share();
    EXPECT_NEAR(solver.stable_step(), expected, 1e-6 * expected);
  }
}

TEST(PoreWater, WithoutAWordItIsExplicitAndSaysWhatProjectedStepsWouldSave) {
  for (const double bulk : {2.2e9, 2e7}) {
    WaterColumn c = small_column();
    c.bulk = bulk;
    MpmOptions o = options_of(c);
    const Solver given(o, scene_of(c), 1);
    EXPECT_EQ(given.pressure_choice(), "");
    o.pressure.reset();
    const Solver left_out(o, scene_of(c), 1);
    EXPECT_THAT(left_out.pressure_choice(), HasSubstr("is explicit: projected steps would be "));
    EXPECT_EQ(left_out.stable_step(), given.stable_step());
  }
}

bool grows(ShapeKind shape, TransferKind transfer, double young, double permeability, double courant, double spread, bool lid = true,
           PressureScheme pressure = PressureScheme::in_steps, double lift = 0) {
  RandomBlock b{shape, transfer, pressure, young, permeability};
  b.spread = spread;
  b.lid = lid;
  b.lift = lift;
  return grows_in(b, courant);
}

// Bounded below the limit, growing above it: without a lid, where waves rule, soon. (In the closed box all short waves strain without
// pressure.)
TEST(PoreWater, StepsBelowTheLimitAreBounded) {
  using enum ShapeKind;
  using enum TransferKind;
  for (const auto& [shape, transfer] : {std::pair{bspline, apic}, {gimp, apic}, {bilinear, apic}, {bilinear, flip}})
    for (const double permeability : {1e-10, 1e-5, 1e-2})
      for (const double young : {1e6, 1e8}) {
        EXPECT_FALSE(grows(shape, transfer, young, permeability, 0.95, 1, false)) << permeability << " " << young;
        for (const double spread : {1.0, 1.5, 1.98})
          EXPECT_FALSE(grows(shape, transfer, young, permeability, 0.95, spread, true, PressureScheme::projected))
              << name_of(shape) << " " << name_of(transfer) << " " << permeability << " " << young << " " << spread;
        EXPECT_TRUE(grows(shape, transfer, young, permeability, permeability < 1e-2 ? 1.55 : 2.05, 1, false)) << permeability << " " << young;
      }
  EXPECT_TRUE(grows(bilinear, flip, 1e6, 1e-10, 1.3, 1, false));  // where waves rule
  EXPECT_FALSE(grows(bilinear, apic, 1e6, 1e-10, 0.95, 1));
  EXPECT_FALSE(grows(bspline, apic, 1e6, 1e-2, 0.95, 1.98));  // where flow rules, and points lie on nodes
  EXPECT_TRUE(grows(bspline, apic, 1e6, 1e-2, 1.15, 1.98));
}

// Wherever in its cells a surface lies: points that pass from one to the next are light there, and strain much.
TEST(PoreWater, ProjectedStepsAreBoundedWhereverTheSurfaceIs) {
  for (const TransferKind transfer : {TransferKind::apic, TransferKind::flip})
    for (const double young : {1e6, 1e8})
      for (int k = 0; k < 20; ++k)
        EXPECT_FALSE(grows(ShapeKind::bspline, transfer, young, 1e-5, 0.95, 1, false, PressureScheme::projected, 2 + 0.0499 * k)) << young << " " << k;
}

}  // namespace
}  // namespace pivnp::mpm

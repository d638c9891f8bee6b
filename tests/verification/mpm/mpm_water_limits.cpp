// What water does to strength, and to the step.
//
// 1. An endless slope with seepage along it (gravity turned, tied sides), friction alone, no dilatancy: strength reduced by R in time until
//    it slides; then it accelerates with g sin b (1 - FS/R). Effective stress carries rho' = rho - rho_w: FS = tan(f)/tan(f_end) with
//    sin(f_end) = tan(b) rho/rho' (Davis 1968 for the planes parallel to the slope, as in mpm_infinite_slope.cpp). Criterion: 2 %.
// 2. Steps over a grid of h, K, K_w and E: random velocities of an open block are bounded at .95 of the stated limit; where growth begins
//    is stated.
#include <gtest/gtest.h>

#include <cmath>

#include "mpm/state/scheme_rows.hpp"
#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// Found over exact.
double safety_with_seepage(double slope_deg, double friction_deg, double porosity, int cells) {
  const double g = 9.81, slope = slope_deg * M_PI / 180, h = 1.0 / cells, young = 2e7;
  MaterialOptions m = saturated(young, 0.3, porosity, 2e-3);
  const double rho = (1 - porosity) * 2650 + porosity * 1000, exact = std::tan(friction_deg * M_PI / 180) / std::tan(std::asin(std::tan(slope) * rho / (rho - 1000)));
  const double reduction = 1.05 * exact;
  m.model = "mohr_coulomb";
  m.friction_deg = friction_deg;
  m.reduction_factor = reduction;
  m.reduction_from_s = 1.2;
  m.reduction_until_s = 1.6;
  Scene s = scene(Grid{{0, 0}, {h, h}, 5, cells + 4}, {rectangle("soil", 0, 0, 4 * h, 1)}, {m});
  s.water.emplace();
  s.water->bulk_modulus_pa = 3 * porosity * young * 1.35;
  BoundaryOptions sides = line({0, 0}, {0, 1 + 2 * h}, "tied");
  sides.across_m = Pair{4 * h, 0};
  s.boundaries = {{"base", line({0, 0}, {4 * h, 0}, "fixed")}, {"sides", sides}};
  MpmOptions o = options({g * std::sin(slope), -g * std::cos(slope)});
  o.gravity_from_m_s2 = Pair{0, -1e-3};
  o.gravity_ramp_s = 1;
  o.initial_equilibrium = false;
  o.end_at_rest = false;
  o.energy_limit = 1e9;
  Solver solver(o, s, 1);
  const auto mean = [&] {
    const MotionFrame f = solver.frame();
    double sum = 0, n = 0;
    for (std::size_t k = 0; k < f.v.size(); ++k)
      if (s.particles.x0[k].y() > 0.8) sum += double(f.v[k][0]), ++n;
    return sum / n;
  };
  solver.advance_to(2, silent);
  const double before = mean();
  solver.advance_to(2.5, silent);
  EXPECT_EQ(solver.ended(), 0u);
  return reduction * (1 - (mean() - before) / 0.5 / (g * std::sin(slope))) / exact;
}

TEST(MpmWetSlopeSmall, FactorOfSafetyWithSeepage) {
  const double found = safety_with_seepage(10, 30, 0.3, 8);
  std::printf("endless slope with seepage, 8 cells: %.4f\n", found);
  EXPECT_NEAR(found, 1, 0.04);
}

TEST(MpmWetSlope, FactorOfSafetyWithSeepage) {
  for (const auto& [slope, friction, porosity] : {std::array{10.0, 30.0, 0.3}, {13.0, 36.0, 0.45}}) {
    const double found = safety_with_seepage(slope, friction, porosity, 20);
    pivnp::test::verification_row("endless slope of " + number(slope) + " deg with seepage along it, friction " + number(friction) + " deg, porosity " + number(porosity, 2) + ", 20 cells high",
                                  "factor of safety over the exact one within 2 %", number(found, 4));
    EXPECT_NEAR(found, 1, 0.02);
  }
}

TEST(MpmWaterStep, OverDecades) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    double least = 10, most = 0;
    int cases = 0;
    for (const double spacing : {0.02, 0.5})
      for (const double permeability : {1e-10, 1e-6, 1e-2})
        for (const double bulk : {1e8, 2.2e9})
          for (const double young : {1e6, 1e8}) {
            RandomBlock b{shape, TransferKind::apic, PressureScheme::in_steps, young, permeability, spacing, bulk};
            b.lid = false;
            EXPECT_FALSE(grows_in(b, 0.95)) << name_of(shape) << " " << spacing << " " << permeability << " " << bulk << " " << young;
            ++cases;
            double factor = 1.05;
            while (factor < 3 && !grows_in(b, factor)) factor += 0.1;
            least = std::min(least, factor);
            most = std::max(most, factor);
          }
    pivnp::test::verification_row("steps of an open saturated block, " + std::string(name_of(shape)) + ", APIC, h .02 .. .5, K 1e-10 .. 1e-2, K_w 1e8 .. 2.2e9, E 1e6 .. 1e8",
                                  "bounded at .95 of the stated limit; stated: where growth begins", "bounded in " + std::to_string(cases) + "; from " + number(least, 3) + " to " + number(most, 3));
    EXPECT_LT(most, 3);
  }
}

}  // namespace
}  // namespace pivnp::mpm

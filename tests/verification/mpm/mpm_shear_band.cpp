// A softening shear band in the solver, on cells of 8, 4 and 2 mm. Criterion: what it dissipates is the same within 10 %
// with either regularisation, smeared (Pietruszczak & Mroz 1981) and non-local (Galavi & Schweiger 2010, m = 2); the
// non-local band is as wide as its length makes it. Without either a band one cell wide dissipates the less the smaller
// the cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/material/shear_band.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
struct Band {
  double dissipated = 0;  // J/m
  double area = 0;        // sheared by more than 0.1, m^2
};

Band shear(const Scene& s, double until) {
  Solver solver(shear_options(), s, 1);
  solver.advance_to(until, silent);
  const MotionFrame frame = solver.frame();
  Band out{solver.energy().plastic, 0};
  for (std::size_t k = 0; k < frame.u.size(); ++k)
    if (frame.field("plastic_dev")(k) > 0.1f) out.area += s.particles.area[k];
  std::printf("cells %.0f mm: dissipated %.2f J, sheared %.2e m^2, steps %lld\n", 1e3 * s.grid.spacing.x(), out.dissipated,
              out.area, static_cast<long long>(solver.steps()));
  std::fflush(stdout);
  return out;
}

// Greatest over least, less one.
double apart(const std::vector<double>& values) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *most / *least - 1;
}

constexpr double cells[] = {0.008, 0.004, 0.002};

std::vector<double> layer(const MaterialOptions& soil) {
  std::vector<double> out;
  for (const double h : cells) out.push_back(shear(sheared_layer(h, soil), 0.06).dissipated);
  return out;
}

TEST(MpmShearBand, SmearedSofteningDissipatesTheSameWhateverTheCells) {
  MaterialOptions soil = softening_soil(12);
  const double wild = apart(layer(soil));
  soil.softening_length_m = 0.02;
  const double smeared = apart(layer(soil));
  pivnp::test::verification_row("shear band, cells 8 to 2 mm, no regularisation", "stated: relative difference in dissipation", number(wild, 2));
  pivnp::test::verification_row("shear band, cells 8 to 2 mm, smeared softening", "dissipation within 0.1", number(smeared, 2));
  EXPECT_GT(wild, 0.2);
  EXPECT_LT(smeared, 0.1);
}

TEST(MpmShearBand, NonlocalSofteningDissipatesTheSameInABandOfTheSameWidth) {
  MaterialOptions soil = softening_soil(20);
  const auto inclined = [&] {
    std::vector<double> dissipated, area;
    for (const double h : cells) {
      const Band band = shear(compressed_specimen(h, soil), 0.04);
      dissipated.push_back(band.dissipated);
      area.push_back(band.area);
    }
    // (Of the two finer ones too: a length of 1.25 cells is hardly resolved.)
    return std::tuple{apart(dissipated), apart(area), apart({area[1], area[2]})};
  };
  const auto [wild, wild_area, wild_finer] = inclined();
  soil.softening_length_m = 0.01;
  soil.softening_average = SofteningAverage::nonlocal;
  const auto [dissipation, area, finer] = inclined();
  pivnp::test::verification_row("inclined shear band, cells 8 to 2 mm, no regularisation",
                                "stated: relative differences in dissipation and sheared area", number(wild, 2) + " and " + number(wild_area, 2));
  pivnp::test::verification_row("inclined shear band, cells 8 to 2 mm, non-local softening, l = 10 mm",
                                "dissipation within 0.1, sheared area within 0.1 where l has 2.5 and 5 cells",
                                number(dissipation, 2) + " and " + number(finer, 2) + " (" + number(area, 2) + " with the cells of 8 mm)");
  EXPECT_GT(wild_area, 0.3);
  EXPECT_LT(dissipation, 0.1);
  EXPECT_GT(wild_finer, 0.3);
  EXPECT_LT(finer, 0.1);
  EXPECT_LT(area, 0.15);
}

}  // namespace
}  // namespace pivnp::mpm

// Numbers and units as printed.
#include "apps/plot/numbers.hpp"
#include "apps/plot/canvas.hpp"
#include "apps/plot/scale.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace pivnp::plot {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Numbers, UncertaintyHasTwoDigitsAndSetsTheValues) {
  EXPECT_EQ(value_with_uncertainty(0.0123456, 0.00056), "0.01235 ± 0.00056");
  EXPECT_EQ(value_with_uncertainty(12.3456, 1.04), "12.3 ± 1.0");
  EXPECT_EQ(value_with_uncertainty(-1.8349, 0.62), "−1.83 ± 0.62");
  EXPECT_EQ(value_with_uncertainty(0.0, 0.00996), "0.000 ± 0.010");  // 0.00996 rounds up to 0.010
  EXPECT_EQ(value_with_uncertainty(1.234e-6, 5.6e-8), "(1.234 ± 0.056) × 10⁻⁶");
  EXPECT_EQ(value_with_uncertainty(3.0e-9, 4.0e-7), "(0.0 ± 4.0) × 10⁻⁷");
  EXPECT_EQ(value_with_uncertainty(2.5, nan), "2.50");
  EXPECT_EQ(value_with_uncertainty(2.5, 0), "2.50");
  EXPECT_EQ(value_with_uncertainty(nan, 1), "n/a");
  EXPECT_EQ(value_with_uncertainty(std::numeric_limits<double>::infinity(), nan), "n/a");
}

// Pressures that are nowhere below zero but for the record's digits are drawn from zero on.
TEST(Scale, RoundOffIsNotTheOtherSideOfZero) {
  std::vector<double> pressures(1000);
  for (std::size_t k = 0; k < pressures.size(); ++k) pressures[k] = k < 20 ? -5e-7 : double(k);
  const Scale above = scale_for(pressures, false);
  EXPECT_NE(above.map, Colours::diverging);
  EXPECT_EQ(above.lower, 0);
  EXPECT_FALSE(above.below);
  pressures[0] = -1;
  EXPECT_EQ(scale_for(pressures, false).map, Colours::diverging);
}

TEST(Numbers, MagnitudesBeginAtZero) {
  std::vector<double> uniform;
  for (int k = 0; k < 100; ++k) uniform.push_back(6.323 + 4e-5 * k);
  EXPECT_GT(scale_for(uniform, false).lower, 6);
  const Scale scale = scale_of_magnitude(uniform);
  EXPECT_EQ(scale.lower, 0);
  EXPECT_FALSE(scale.below);
}

TEST(Numbers, Numbers) {
  EXPECT_EQ(significant(0.5), "0.500");
  EXPECT_EQ(significant(0), "0");
  EXPECT_EQ(significant(99.96, 3), "100");
  EXPECT_EQ(significant(1.5e-7, 2), "1.5 × 10⁻⁷");
  EXPECT_EQ(significant(-30e6, 2), "−3.0 × 10⁷");
  EXPECT_EQ(plain(0.5), "0.5");
  EXPECT_EQ(plain(120), "120");
  EXPECT_EQ(plain(-0.020004), "−0.02");
  EXPECT_EQ(plain(2e-7), "2 × 10⁻⁷");
  EXPECT_EQ(percent(1), "100 %");
  EXPECT_EQ(percent(0.99999), "> 99.9 %");
  EXPECT_EQ(percent(0.0001), "< 0.1 %");
  EXPECT_EQ(percent(0.423), "42.3 %");
  EXPECT_EQ(percent(nan), "n/a");
  EXPECT_EQ(count(1, "particle"), "1 particle");
  EXPECT_EQ(count(1234567, "particle"), "1\u202f234\u202f567 particles");
}

TEST(Numbers, UnitsSuitTheirNumbers) {
  EXPECT_EQ(display_unit("m", 0.02).name, "mm");
  EXPECT_EQ(display_unit("m", 20).name, "m");
  EXPECT_EQ(display_unit("m", 0).name, "m");
  EXPECT_EQ(display_unit("px", 0.02).name, "px");
  EXPECT_EQ(display_unit("Pa", 500).name, "Pa");
  EXPECT_EQ(display_unit("Pa", 60000).name, "kPa");
  EXPECT_EQ(display_unit("Pa", 3e6).name, "MPa");
  EXPECT_DOUBLE_EQ(display_unit("Pa", 3e6).factor, 1e-6);
  EXPECT_DOUBLE_EQ(display_unit("m", 1e-5).factor, 1e6);
}

// One tick tells no scale: whatever the range, two multiples of the step lie in it at least.
TEST(Numbers, AxesHaveTwoTicks) {
  for (const auto& [lower, upper, wanted] : {std::array{-2.9, 2.9, 5.0}, {0.01, 0.26, 0.2}, {0.9, 1.1, 0.5}, {-0.03, 0.56, 0.1}, {3.0, 3.4, 1.0}}) {
    const double step = step_with_ticks(lower, upper, wanted);
    EXPECT_LE(step, wanted);
    EXPECT_GE(std::floor(upper / step) - std::ceil(lower / step) + 1, 2) << lower << " to " << upper << " by " << step;
  }
  EXPECT_EQ(step_with_ticks(0, 10, 2), 2);
}

}  // namespace
}  // namespace pivnp::plot

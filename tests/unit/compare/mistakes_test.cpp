// Mistakes of origin, units and axes between two data sets are named by the outlines they begin with; without one nothing is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "compare/alignment/mistakes.hpp"
#include "pivnp/core/error.hpp"
#include "tests/unit/compare/motions.hpp"

namespace pivnp::compare {
namespace {

using testing::HasSubstr;

// A slope in section, as wide as 1.8 at its base: y <= 0.7, below a face and beside a notch.
bool in_slope(const Vec2& x) { return x.x() > 0.1 && x.y() > 0.05 && x.y() < 0.7 && x.y() < 1.15 - 0.6 * x.x() && !(x.x() < 0.3 && x.y() > 0.5); }

MotionMemory slope_of(const std::string& name, double h, const Vec2& offset, const std::function<Vec2(const Vec2&)>& seen) {
  std::vector<Vec2> x;
  for (const Vec2& p : square_lattice(int(2 / h), int(1 / h), h, offset))
    if (in_slope(p)) x.push_back(seen(p));
  const double size = (seen(Vec2(1, 0)) - seen(Vec2(0, 0))).norm();
  return motion_of(name, particles_at(x, h * size), {0, 1}, [](const Vec2&, double t) -> Vec2 { return {0.01 * t, 0}; });
}

std::vector<std::string> doubts_of(double h1, double h2, const Vec2& offset, const std::function<Vec2(const Vec2&)>& seen) {
  const MotionMemory first = slope_of("lab", h1, Vec2::Zero(), [](const Vec2& x) { return x; }), second = slope_of("sim", h2, offset, seen);
  SilentProgress progress;
  try {
    return compare(first, second, {}, {}, progress).doubts;
  } catch (const InputError& error) {
    return {error.what()};  // no particle finds a partner
  }
}

TEST(Mistakes, AreNamed) {
  const auto turn = [](double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    return [a](const Vec2& x) { return Vec2(std::cos(a) * x.x() - std::sin(a) * x.y(), std::sin(a) * x.x() + std::cos(a) * x.y()); };
  };
  const struct {
    const char* what;
    std::function<Vec2(const Vec2&)> seen;
    const char* words;
  } cases[] = {
      {"shift", [](const Vec2& x) { return Vec2(x + Vec2(0.05, 0)); }, "moved by (-0.0"},
      {"far shift", [](const Vec2& x) { return Vec2(x + Vec2(40, -3)); }, "moved by (-40, 3"},
      {"axes", [](const Vec2& x) { return Vec2(x.y(), x.x()); }, "axes in exchange"},
      {"upside down", [](const Vec2& x) { return Vec2(x.x(), 1 - x.y()); }, "upside down"},
      {"rows downwards", [](const Vec2& x) { return Vec2(x.x(), -x.y()); }, "upside down"},
      {"mirror", [](const Vec2& x) { return Vec2(2 - x.x(), x.y()); }, "from left to right"},
      {"mm", [](const Vec2& x) { return Vec2(1000 * x); }, "unit of length"},
      {"cm", [](const Vec2& x) { return Vec2(0.01 * x); }, "unit of length"},
      {"6 % larger", [](const Vec2& x) { return Vec2(1.06 * x); }, "% smaller in both directions"},
      {"12 % larger", [](const Vec2& x) { return Vec2(1.12 * x); }, "% smaller in both directions"},
      {"a fifth smaller", [](const Vec2& x) { return Vec2(0.8 * x); }, "% larger in both directions"},
      {"turn", turn(6), "turned by -5"},
  };
  for (const auto& c : cases) {
    const std::vector<std::string> doubts = doubts_of(0.02, 0.027, Vec2(0.007, 0.011), c.seen);
    ASSERT_EQ(doubts.size(), 1u) << c.what;
    EXPECT_THAT(doubts[0], HasSubstr(c.words)) << c.what;
  }
}

// Other particles of the same body, to the fourfold spacing; and a data set that sees a part of it alone.
TEST(Mistakes, AreNotNamedWithoutOne) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> share(0, 1);
  for (int k = 0; k < 12; ++k) {
    const double h1 = 0.02 + 0.025 * share(random), h2 = h1 * std::pow(4, 2 * share(random) - 1);
    const Vec2 offset(h2 * share(random), h2 * share(random));
    EXPECT_TRUE(doubts_of(h1, h2, offset, [](const Vec2& x) { return x; }).empty()) << h1 << " " << h2 << " " << offset.transpose();
  }
  for (int k = 0; k < 12; ++k) {
    const double h = 0.02 + 0.02 * share(random), left = 0.2 + 0.5 * share(random), top = 0.3 + 0.3 * share(random);
    const MotionMemory whole = slope_of("sim", h, Vec2::Zero(), [](const Vec2& x) { return x; });
    std::vector<Vec2> seen;
    for (const Vec2& x : whole.particles().x0)
      if (x.x() > left && x.y() < top) seen.push_back(x + Vec2(0.3 * h, 0.4 * h));
    const MotionMemory part = motion_of("lab", particles_at(seen, h), {0, 1}, [](const Vec2&, double t) -> Vec2 { return {0.01 * t, 0}; });
    SilentProgress progress;
    EXPECT_TRUE(compare(part, whole, {}, {}, progress).doubts.empty()) << h << " " << left << " " << top;
  }
}

}  // namespace
}  // namespace pivnp::compare

// What is outside the equations of heat is flagged in every state: hotter than 100 degrees, and a band's pressure above the total mean stress.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/verification/mpm/planar_slide.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

// The planar slide on coarse cells, started near 100 degrees, one half cooler: some points grow hotter, in some the band would open.
TEST(HeatLimit, FlagsBandsThatBoilOrOpen) {
  HeatedBand band;
  band.thickness = 0.1;
  PlanarSlide slide(band);
  SlideOptions o;
  o.cell = 2;
  o.above = 12;
  Scene s = slide_scene(slide, o);
  s.heat->initial_c = 95;
  for (const Vec2& x : s.particles.x0) s.temperature0.push_back(x.x() < o.cell ? 92 : 98);
  Solver solver(slide_options(slide, o), s, 1);
  std::size_t times[4] = {};
  for (double t = 0; t <= 16; t += 0.5) {
    solver.advance_to(t, silent);
    const MotionFrame f = solver.frame();
    for (std::size_t k = 0; k < f.u.size(); ++k) {
      const auto of = [&](const char* name, std::size_t c = 0) { return double(f.field(name)(k, c)); };
      const double total = -(of("stress", 0) + of("stress", 1) + of("stress", 2)) / 3 + of("pressure");
      const double over = of("band_pressure") - std::max(0.0, total);
      if (std::abs(over) < 1 || std::abs(of("band_temperature") - 100) < 1e-3) continue;  // the record's digits
      const bool hot = of("band_temperature") > 100, opens = over > 0 && of("band_pressure") > of("pressure") + 1;
      const int code = (hot ? 1 : 0) + (opens ? 2 : 0);
      ASSERT_EQ(int(of("heat_limit")), code) << t << " s, point " << k;
      ++times[code];
    }
  }
  for (const std::size_t count : times) EXPECT_GT(count, 0u);
}

}  // namespace
}  // namespace pivnp::mpm

// What is outside the equations of heat is flagged in every state: hotter than 100 degrees, and a band's pressure above
// the total mean stress. What passes on more water than it held is not, and is kept in the books.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/verification/mpm/planar_slide.hpp"
#include "tests/verification/mpm/water_column.hpp"

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

// Water that swells in a warm block with an imposed level leaves its points, more of it than they held: it stays in the
// books.
TEST(HeatLimit, PointsMayOweWater) {
  const double h = 0.05;
  MaterialOptions m = saturated(1e6, 0.2, 0.3, 1e-3);
  m.grain_specific_heat_j_kg_k = 800;
  m.conductivity_w_m_k = 4000;
  m.grain_thermal_expansion_1_k = 0;
  m.skeleton_thermal_expansion_1_k = 0;
  Scene s = scene(Grid{{0, 0}, {h, h}, 4, 5}, {rectangle("soil", 0, 0, 3 * h, 4 * h)}, {m});
  s.boundaries = {{"base", line({0, 0}, {3 * h, 0}, "fixed")},
                  {"left", line({0, 0}, {0, 4 * h}, "roller")},
                  {"right", line({3 * h, 0}, {3 * h, 4 * h}, "roller")}};
  s.boundaries[0].second.temperature_c = 60;
  s.water.emplace();
  s.water->bulk_modulus_pa = 1e6;
  s.water->thermal_expansion_1_k = 0.04;  // (a hundred times that of water)
  s.water->level_m = 4 * h;
  s.water->groundwater = Groundwater::level;
  s.heat.emplace();
  MpmOptions o = options({0, -9.81});
  o.initial_equilibrium = true;
  o.end_at_rest = false;
  Solver solver(o, s, 1);
  solver.find_initial_equilibrium(silent);
  const EnergyRow start = solver.energy();
  solver.advance_to(1, silent);
  const EnergyRow end = solver.energy();
  EXPECT_LT(end.water_inflow, -0.3 * start.water_mass);
  EXPECT_LT(std::abs(end.water_mass - start.water_mass - end.water_inflow), 1e-12 * start.water_mass);
}

}  // namespace
}  // namespace pivnp::mpm

// The water's surface inside the soil, found by time stepping (docs/theory/mpm_water.md).
//
// 1. A dam with upright faces between two levels: discharge K (H1^2 - H2^2)/(2 L), which is exact (Dupuit 1863; Charny 1951; Muskat
//    1937), within 3 %, where water fills the dam or drains from it.
// In small: on 14 cells, filled.
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

struct Dam {
  double high = 0.8, low = 0.3, length = 1, height = 1, permeability = 0.1, bulk = 1e5;
  int cells = 14;  // in the height
  ShapeKind shape = ShapeKind::bilinear;
  double start = 0.8;  // level inside
};

struct Seepage {
  double discharge, balance, lowest;  // over Dupuit's; inflow less outflow over it; lowest pressure, Pa
};

Seepage seep(const Dam& d) {
  const double h = d.height / d.cells;
  const int across = int(std::lround(d.length / h));
  MaterialOptions soil = saturated(1e6, 0.2, 0.3, d.permeability);
  Scene s = scene(Grid{{0, 0}, {h, h}, across + 1, d.cells + 3}, {rectangle("soil", 0, 0, d.length, d.height)}, {soil});
  s.water.emplace();
  s.water->bulk_modulus_pa = d.bulk;
  s.water->level_m = d.start;
  s.boundaries = {{"base", line({0, 0}, {d.length, 0}, "fixed")},
                  {"up", line({0, 0}, {0, d.height + 2 * h}, "roller")},
                  {"down", line({d.length, 0}, {d.length, d.height + 2 * h}, "roller")}};
  s.boundaries[1].second.water_level_m = d.high;
  s.boundaries[2].second.water_level_m = d.low;
  MpmOptions o = options({0, -9.81});
  o.shape = d.shape;
  if (d.shape == ShapeKind::bilinear) o.transfer = TransferKind::flip, o.stress_update = StressUpdate::musl;
  o.damping = 0.3;
  o.initial_equilibrium = false;
  o.k0 = 0.5;
  o.end_at_rest = false;
  o.energy_limit = 1e9;
  Solver solver(o, s, 1);
  const EnergyRow start = solver.energy();
  // Times of the surface: n L^2/(K H).
  const double time = 0.3 * d.length * d.length / (d.permeability * d.high);
  solver.advance_to(1.8 * time, silent);
  const EnergyRow a = solver.energy();
  EXPECT_LT(std::abs(a.water_mass - start.water_mass - a.water_inflow), 1e-9 * start.water_mass);
  const MotionFrame f = solver.frame();
  // Through the middle third: the mean of the flow over the points, times the area over the length.
  double flow = 0, area = 0, lowest = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    lowest = std::min(lowest, double(f.field("pressure")(k, 0)));
    const double x = s.particles.x0[k].x() / d.length;
    if (x < 0.3 || x > 0.7) continue;
    flow += double(s.particles.area[k]) * double(f.field("water_flow")(k, 0));
    area += double(s.particles.area[k]);
  }
  const double through = flow / (area / d.height), dupuit = d.permeability * (d.high * d.high - d.low * d.low) / (2 * d.length);
  solver.advance_to(2 * time, silent);
  const double net = (solver.energy().water_inflow - a.water_inflow) / 1000 / (0.2 * time);
  return {through / dupuit, net / dupuit, lowest};
}

TEST(MpmSeepageSmall, ThroughADam) {
  Dam d;
  d.start = 0.3;
  const Seepage s = seep(d);
  std::printf("dam, 14 cells, filled: discharge %.4f of Dupuit's, net %.4f, lowest %.3g\n", s.discharge, s.balance, s.lowest);
  EXPECT_NEAR(s.discharge, 1, 0.03);
  EXPECT_NEAR(s.balance, 0, 0.02);
  EXPECT_GE(s.lowest, 0);
}

TEST(MpmSeepage, ThroughADam) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::bspline}) {
    double worst = 0;
    for (const double start : {0.3, 0.8}) {
      Dam d;
      d.shape = shape;
      d.cells = 20;
      d.start = start;
      const Seepage s = seep(d);
      worst = std::max(worst, std::abs(s.discharge - 1));
      EXPECT_NEAR(s.balance, 0, 0.02);
      EXPECT_GE(s.lowest, 0);
    }
    pivnp::test::verification_row("dam between levels of 0.8 and 0.3 of its height, " + std::string(name_of(shape)) + ", 20 cells, filled and drained to the steady surface",
                                  "discharge within 3 % of K (H1^2 - H2^2)/(2 L)", number(100 * worst, 2) + " %");
    EXPECT_LT(worst, 0.03);
  }
}

}  // namespace
}  // namespace pivnp::mpm

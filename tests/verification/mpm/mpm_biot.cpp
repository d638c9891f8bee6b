// Biot's fast wave in a saturated column (Biot 1956), in which skeleton and water move together: undrained, a pulse runs at
// c_u = sqrt((M + K_w/n)/rho), within 1 %. (The slow wave is diffusion without the water's own inertia: Terzaghi's rows.)
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

double speed_of_fast_wave(ShapeKind shape, int cells) {
  WaterColumn c;
  c.young = 1e7;
  c.bulk = 3e8;
  c.permeability = 1e-9;
  c.height = 1;
  c.cells = cells;
  c.load = 0;
  c.damping = 0;
  c.shape = shape;
  if (shape == ShapeKind::bilinear) c.transfer = TransferKind::flip, c.stress = StressUpdate::musl;
  Scene s = scene_of(c);
  const double undrained = c.modulus() + c.bulk / c.porosity, speed = std::sqrt(undrained / c.density());
  for (const Vec2& x : s.particles.x0) s.v0.emplace_back(0, 1e-4 * std::exp(-std::pow((x.y() - 0.5) / 0.08, 2)));
  Solver solver(options_of(c), s, 1);
  // Two halves leave the middle; the centre of the upper one, by energy.
  const auto centre = [&] {
    const MotionFrame f = solver.frame();
    double sum = 0, weight = 0;
    for (std::size_t k = 0; k < f.v.size(); ++k) {
      if (s.particles.x0[k].y() < 0.5) continue;
      const double w = std::pow(double(f.v[k][1]), 2);
      sum += w * s.particles.x0[k].y();
      weight += w;
    }
    return sum / weight;
  };
  const double early = 0.18 / speed, late = 0.3 / speed;
  solver.advance_to(early, silent);
  const double from = centre();
  solver.advance_to(late, silent);
  return (centre() - from) / (late - early) / speed;
}

TEST(MpmBiotSmall, FastWave) {
  const double fast = speed_of_fast_wave(ShapeKind::bspline, 100);
  std::printf("fast wave, 100 cells: %.4f\n", fast);
  EXPECT_NEAR(fast, 1, 0.01);
}

TEST(MpmBiot, FastWave) {
  for (const ShapeKind shape : {ShapeKind::bilinear, ShapeKind::gimp, ShapeKind::bspline}) {
    const double fast = speed_of_fast_wave(shape, 100);
    pivnp::test::verification_row("Biot's fast wave in an undrained column, " + std::string(name_of(shape)) + ", pulse of 16 cells",
                                  "speed within 1 % of sqrt((M + K_w/n)/rho)", number(fast, 5));
    EXPECT_NEAR(fast, 1, 0.01);
  }
}

}  // namespace
}  // namespace pivnp::mpm

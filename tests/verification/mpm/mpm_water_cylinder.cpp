// An undrained deep cylinder in plane strain: saturated Tresca soil, no permeability, Poisson's ratio of the mixture
// .4993, beside dry soil of .49 on the same mesh (mpm_bearing.cpp, where the dry one is held against Randolph & Houlsby
// 1984: 9.14 smooth, 11.94 rough). Criterion: N = F/(s_u D) within 5 % of the dry one, and what it is over the exact
// one is stated; of the cells' pressures within a radius of the surface the part that alternates along both axes below
// 3 % of the mean.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/verification/mpm/water_column.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;

constexpr double clay_strength = 1000, clay_young = 3e5, clay_density = 2000;

struct WetCylinder {
  double resistance, checkerboard;
};

// What alternates along both axes over the mean, of cells around a place.
double alternating_around(const Scene& s, const MotionFrame& f, bool wet, const Vec2& centre, double h) {
  std::map<std::pair<int, int>, std::pair<double, int>> of_cell;
  for (std::size_t k = 0; k < f.u.size(); ++k) {
    const Vec2 x = s.particles.x0[k] + Vec2(double(f.u[k][0]), double(f.u[k][1]));
    auto& [sum, n] = of_cell[{int(std::floor(x.x() / h)), int(std::floor(x.y() / h))}];
    sum +=
        wet ? double(f.field("pressure")(k, 0))
            : -double(f.field("stress")(k, 0) + f.field("stress")(k, 1) + f.field("stress")(k, 2)) / 3 - 20 * clay_strength;
    ++n;
  }
  double odd = 0, size = 0;
  for (const auto& [cell, value] : of_cell) {
    const auto [i, j] = cell;
    const double away = (h * Vec2(i + 0.5, j + 0.5) - centre).norm();
    if (away < 0.5 + 1.5 * h || away > 1) continue;
    double q = 0;
    bool all = true;
    for (int a = -1; a < 2; ++a)
      for (int b = -1; b < 2; ++b) {
        const auto at = of_cell.find({i + a, j + b});
        all = all && at != of_cell.end();
        if (all) q += (a ? 1 : -2) * (b ? 1 : -2) * at->second.first / at->second.second / 16;
      }
    if (!all) continue;
    odd += std::abs(q);
    size += std::abs(value.first / value.second);
  }
  return odd / size;
}

// Half of it, moved along its plane of symmetry.
WetCylinder wet_cylinder(bool rough, int cells, bool wet, double way = 0.2) {
  const double h = 1.0 / cells, pressure = 20 * clay_strength, poisson = wet ? 0.3 : 0.49, shear = clay_young / 2 / (1 + poisson);
  const int half = int(2.5 * cells);
  MaterialOptions m = wet ? saturated(clay_young, poisson, 0.4, 0, 2667) : elastic(clay_young, poisson, clay_density);
  m.model = "tresca";
  m.shear_strength_pa = clay_strength;
  Scene s = scene(Grid{{-half * h, 0}, {h, h}, 2 * half + 1, half + 1},
                  {rectangle("clay", -half * h, 0, half * h, half * h)}, {m});
  if (wet) {
    s.water.emplace();
    s.water->bulk_modulus_pa = 0.4 * 2 * shear * 1.4993 / (3 * (1 - 2 * 0.4993));
  }
  keep_outside(s.particles, {0, 0}, 0.5);
  s.stress0.assign(s.particles.size(), {-pressure, -pressure, -pressure, 0});
  const double side = half * h;
  s.boundaries = {{"low", line({-side, 0}, {side, 0}, "roller")},
                  {"left", line({-side, 0}, {-side, side}, "roller")},
                  {"right", line({side, 0}, {side, side}, "roller")},
                  {"high", line({-side, side}, {side, side}, "roller")}};
  RigidOptions body;
  body.circle_m = {0, 0, 0.5};
  const double v = 0.0015 * std::sqrt(51 * shear / clay_density);  // as the dry one of nu .49
  body.velocity_m_s = {v, 0};
  if (!rough) body.friction = 0;
  s.bodies = {{"cylinder", body}};
  MpmOptions o = options();
  o.locking = Locking::fbar;
  o.initial_equilibrium = false;
  if (wet) o.pressure = PressureScheme::in_steps;
  Solver solver(o, s, 2);
  solver.advance_to(0.5 * way / v, silent);
  const double from = solver.body_impulse(0).x();
  double checkerboard = 0;
  constexpr int looks = 5;
  for (int k = 1; k <= looks; ++k) {
    solver.advance_to((0.5 + 0.5 * k / looks) * way / v, silent);
    checkerboard += alternating_around(s, solver.frame(), wet, {v * solver.time(), 0}, h) / looks;
  }
  return {2 * (solver.body_impulse(0).x() - from) / (0.5 * way / v) / clay_strength, checkerboard};
}

TEST(MpmWetCylinder, SmoothAndRough) {
  for (const bool rough : {false, true}) {
    const double exact = rough ? 11.94 : 9.14;
    const int cells = rough ? 24 : 16;
    const WetCylinder dry = wet_cylinder(rough, cells, false), wet = wet_cylinder(rough, cells, true);
    pivnp::test::verification_row(
        std::string("deep cylinder, undrained, ") + (rough ? "rough" : "smooth") + ", " + std::to_string(cells) +
            " cells a diameter",
        "N within 5 % of the dry soil's with nu .49 (exact " + number(exact, 4) + "), checkerboard below 3 %",
        number(wet.resistance, 4) + " (dry " + number(dry.resistance, 4) + "), " + number(100 * wet.checkerboard, 2) +
            " % (dry " + number(100 * dry.checkerboard, 2) + " %)");
    EXPECT_NEAR(wet.resistance, dry.resistance, 0.05 * dry.resistance);
    EXPECT_LT(wet.checkerboard, 0.03);
  }
}

}  // namespace
}  // namespace pivnp::mpm

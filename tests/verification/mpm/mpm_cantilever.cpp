// A cantilever that bends far under its own weight.
//
// Reference: Reissner's beam (1972, J. Appl. Math. Phys. 23:795), exact for finite rotations, with axial and shear
// stiffness; plane strain enters by E/(1 - nu^2). Along the axis s, with the weight q per length acting down,
//   M' = N gamma - Q (1 + eps),   theta' = M/EI,   eps = N/EA,   gamma = Q/(5/6 G A),
//   N = -q (L - s) sin(theta), Q = -q (L - s) cos(theta)   (theta from the horizontal, positive up),
// solved by shooting on M(0).
// Criterion: at 4 cells over the depth and 9 points a cell the tip's deflection is within 2 % of the reference, at 16
// points within 1 %: what is left comes from the points' uneven places once the beam is bent, not from the cells.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "pivnp/core/text.hpp"
#include "tests/support/silent.hpp"
#include "tests/support/verification.hpp"
#include "tests/unit/mpm/scenes.hpp"

namespace pivnp::mpm {
namespace {

using namespace test;
constexpr double length = 1, depth = 0.125, young = 1e6, poisson = 0.3, density = 1000, gravity = 6.0;

struct Beam {
  double moment, angle, x, y;
};

Beam shoot(double root_moment) {
  const double plane = young / (1 - poisson * poisson), EI = plane * depth * depth * depth / 12, EA = plane * depth,
               GA = 5.0 / 6 * young / (2 * (1 + poisson)) * depth, q = density * gravity * depth;
  const auto slope = [&](double s, const Beam& b) {
    const double N = -q * (length - s) * std::sin(b.angle), Q = -q * (length - s) * std::cos(b.angle);
    const double stretch = 1 + N / EA, gamma = Q / GA, c = std::cos(b.angle), n = std::sin(b.angle);
    return Beam{N * gamma - Q * stretch, b.moment / EI, stretch * c - gamma * n, stretch * n + gamma * c};
  };
  const auto along = [](const Beam& b, const Beam& d, double t) {
    return Beam{b.moment + t * d.moment, b.angle + t * d.angle, b.x + t * d.x, b.y + t * d.y};
  };
  Beam b{root_moment, 0, 0, 0};
  constexpr int steps = 400;
  const double ds = length / steps;
  for (int k = 0; k < steps; ++k) {  // Runge-Kutta
    const double s = k * ds;
    const Beam k1 = slope(s, b), k2 = slope(s + ds / 2, along(b, k1, ds / 2)),
               k3 = slope(s + ds / 2, along(b, k2, ds / 2)), k4 = slope(s + ds, along(b, k3, ds));
    b = along(along(along(along(b, k1, ds / 6), k2, ds / 3), k3, ds / 3), k4, ds / 6);
  }
  return b;
}

// Deflection of the tip's axis, downward: bisection on the root's moment until the tip carries none.
double reference_deflection() {
  double low = -density * gravity * depth * length * length, high = 0;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (shoot(middle).moment > 0 ? high : low) = middle;
  }
  return -shoot(0.5 * (low + high)).y;
}

double deflection(int cells, int per_cell) {
  const double h = depth / cells;
  const int across = int(std::lround(1.25 * length / h)), up = int(std::lround(0.875 * length / h));
  const double bottom = 0.625 * length;  // room for the tip to come down
  Scene s = scene(Grid{{0, -bottom}, {h, h}, across + 1, up + 1}, {rectangle("beam", 0, 0, length, depth)},
                  {elastic(young, poisson, density)}, per_cell);
  s.boundaries = {{"wall", line({0, -bottom}, {0, 0.25 * length}, "fixed")}};
  MpmOptions o = options({0, -gravity});
  o.locking = Locking::none;
  o.initial_equilibrium = false;
  o.damping = 0.5;
  Solver solver(o, s, 1);
  solver.advance_to(8, silent);  // four swings
  EXPECT_LT(solver.energy().kinetic, 1e-7 * solver.energy().elastic);
  const MotionFrame f = solver.frame();
  double sum = 0;
  int n = 0;
  double last = 0;
  for (const Vec2& x : s.particles.x0) last = std::max(last, x.x());
  for (std::size_t k = 0; k < f.u.size(); ++k)
    if (s.particles.x0[k].x() > last - 0.1 * h) {
      sum += double(f.u[k][1]);
      ++n;
    }
  // From the last points to the tip, along the axis there (the beam is straight near its free end).
  double before = 0;
  int m = 0;
  for (std::size_t k = 0; k < f.u.size(); ++k)
    if (std::abs(s.particles.x0[k].x() - (last - 2 * h)) < 0.1 * h) {
      before += double(f.u[k][1]);
      ++m;
    }
  return -(sum / n + (sum / n - before / m) / (2 * h) * (length - last));
}

TEST(MpmCantilever, BendsAsABeamOfFiniteRotation) {
  const double reference = reference_deflection();
  EXPECT_GT(reference, 0.3 * length);  // far beyond linear theory
  const double few = deflection(4, 4) / reference, more = deflection(4, 9) / reference, most = deflection(4, 16) / reference;
  std::printf("cantilever: tip at %.4f of the length; over it with 4, 9, 16 points a cell: %.4f, %.4f, %.4f\n", reference,
              few, more, most);
  for (const auto& [points, ratio] : {std::pair{9, more}, {16, most}})
    pivnp::test::verification_row("cantilever under its weight, " + std::to_string(points) + " points a cell",
                                  points == 9 ? "tip's deflection over the beam's within 2 %" : "within 1 %", number(ratio, 4));
  EXPECT_NEAR(more, 1, 0.02);
  EXPECT_NEAR(most, 1, 0.01);
  EXPECT_LT(std::abs(more - 1), std::abs(few - 1));
}

}  // namespace
}  // namespace pivnp::mpm

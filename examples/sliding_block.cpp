// An elastic block slides down a plane inclined by 30 degrees with friction 0.2: simulated against g (sin t - mu cos t) t^2/2.
// Gravity is turned in place of the plane. Prints time, simulated and analytic path, in m; exit code 1 beyond 2 %.
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

int main() try {
  using namespace pivnp;
  const double slope = 30 * std::numbers::pi / 180, friction = 0.2, g = 9.81, density = 2000, height = 0.05;

  // A block of 100 x 50 mm on cells of 10 mm, four points each.
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {0.01, 0.01}, 81, 12};
  const Region block{"block", Polygon({{0.05, 0}, {0.15, 0}, {0.15, height}, {0.05, height}}, "block")};
  scene.particles = seed(scene.grid, {block}, 4, SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions rubber;
  rubber.model = "linear_elastic";
  rubber.density_kg_m3 = density;
  rubber.young_pa = 2e6;
  rubber.poisson = 0.2;
  scene.materials = {rubber};
  // It starts with the stresses of its own weight, so that it does not bounce.
  for (const Vec2& x : scene.particles.x0) {
    const double across = -density * g * std::cos(slope) * (height - x.y());
    scene.stress0.push_back({0.25 * across, across, 0.25 * across, 0});
  }
  mpm::BoundaryOptions plane;
  plane.line_m = {{0, 0}, {0.8, 0}};
  plane.type = mpm::BoundaryType::frictional;
  plane.friction = friction;
  scene.boundaries = {{"plane", plane}};

  mpm::MpmOptions options;
  options.gravity_m_s2 = {g * std::sin(slope), -g * std::cos(slope)};
  mpm::Solver solver(options, scene, 1);
  SilentProgress silent;
  double simulated = 0, analytic = 0;
  for (const double time : {0.1, 0.2, 0.3}) {
    solver.advance_to(time, silent);
    const MotionFrame frame = solver.frame();
    simulated = 0;
    for (const auto& u : frame.u) simulated += double(u[0]) / double(frame.u.size());
    analytic = 0.5 * g * (std::sin(slope) - friction * std::cos(slope)) * time * time;
    std::printf("%.1f %.5f %.5f\n", time, simulated, analytic);
  }
  return std::abs(simulated - analytic) <= 0.02 * analytic ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 1;
}

// Million particle-steps per second of the column of the peers' comparison: L x L in a box 2L x 1.2L, 2 x 2 particles a
// cell, E 1e6, nu 0.3, rho 2000, g 9.81, dt = 0.2 h/c_p, fixed base, sliding walls; set-up left out.
//   mpm_throughput [particles ...]          (default 10000 100000)
// "moving" is the same block thrown through the box: particles change cells.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "mpm/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

using namespace pivnp;

namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

mpm::Scene column(int cells, const std::string& model, bool moving) {
  const double h = 1.0 / cells;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, 2 * cells + 1, int(1.2 * cells) + 1};
  scene.particles = seed(scene.grid, {{"soil", Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "soil")}}, 4,
                         SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions m;
  m.model = model;
  m.young_pa = 1e6;
  m.density_kg_m3 = 2000;
  m.friction_deg = 30;
  scene.materials = {m};
  mpm::BoundaryOptions base, left, right;
  base.line_m = {{0, 0}, {2, 0}};
  left.line_m = {{0, 0}, {0, 1.2}};
  right.line_m = {{2, 0}, {2, 1.2}};
  left.type = right.type = "roller";
  scene.boundaries = {{"base", base}, {"left", left}, {"right", right}};
  if (moving) scene.v0.assign(scene.particles.size(), Vec2(2.5, 0.0));  // a tenth of the wave speed
  return scene;
}

double rate(int cells, const std::string& model, bool moving, int threads) {
  mpm::MpmOptions options;
  options.courant = 0.2;
  if (moving) options.gravity_m_s2 = {0, 0};
  mpm::Solver solver(options, column(cells, model, moving), threads);
  SilentProgress silent;
  const double dt = solver.stable_step(), n = double(solver.particles().size());
  solver.advance_to(20 * dt, silent);
  const auto steps = solver.steps();
  const auto start = std::chrono::steady_clock::now();
  solver.advance_to((20 + std::max(50.0, 1.5e7 / n)) * dt, silent);
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return double(solver.steps() - steps) * n / s / 1e6;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<int> sizes;
  for (int a = 1; a < argc; ++a) sizes.push_back(std::atoi(argv[a]));
  if (sizes.empty()) sizes = {10000, 100000};
  std::printf("machine: %s, %u hardware threads; bilinear MUSL, double precision, guards and energy on\n",
              processor().c_str(), std::thread::hardware_concurrency());
  std::printf("%10s  %-22s %8s %8s   M particle-steps/s with 1, 2 threads\n", "particles", "material", "1", "2");
  for (const int size : sizes) {
    const int cells = std::max(2, int(std::lround(std::sqrt(size / 4.0))));
    for (const bool moving : {false, true})
      for (const char* model : {"linear_elastic", "mohr_coulomb"})
        std::printf("%10d  %-22s %8.1f %8.1f\n", 4 * cells * cells,
                    (std::string(model) + (moving ? " moving" : "")).c_str(), rate(cells, model, moving, 1),
                    rate(cells, model, moving, 2));
  }
}

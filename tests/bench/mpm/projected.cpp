// What a simulated second costs with pressure explicit and projected: a saturated slope that moves under its own weight.
//   mpm_projected [seconds=0.02] [runs=3] [threads=1] [over=0] [only=]
// over: of the water over the crown, m. At 0 the crown dries as it sinks and dilates, and explicit pressure then follows the water's surface
// inside, which projected pressure does not have: above 0 both do the same. only: the soil whose name begins so. Each figure is the median of `runs`, the two schemes in turn; by the processor's time.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

using namespace pivnp;

namespace {

struct Soil {
  const char* name;
  double young, porosity, permeability, spacing, height;
};
const Soil soils[] = {{"slope, E 20 MPa, n .4, K 1e-5", 20e6, 0.4, 1e-5, 0.125, 5},
                      {"soft clay, E 2 MPa, n .5, K 1e-9", 2e6, 0.5, 1e-9, 0.1, 4}};

struct Run {
  double seconds, steps;  // of the processor, a simulated second
};

Run measure(const Soil& soil, mpm::PressureScheme pressure, double time, int threads, double over) {
  const double h = soil.spacing, H = soil.height;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, int(4.5 * H / h) + 1, int(1.2 * H / h) + 1};
  scene.particles = seed(scene.grid, {{"soil", Polygon({{0, 0}, {4.5 * H, 0}, {4.5 * H, 0.4 * H}, {2.5 * H, 0.4 * H}, {1.5 * H, H}, {0, H}}, "soil")}}, 4,
                         SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions m;
  m.model = "mohr_coulomb";
  m.young_pa = soil.young;
  m.poisson = 0.33;
  m.porosity = soil.porosity;
  m.grain_density_kg_m3 = 2700;
  m.permeability_m_s = soil.permeability;
  m.friction_deg = 28;
  m.cohesion_pa = 1000;
  scene.materials = {m};
  scene.water.emplace();
  scene.water->level_m = H + over;
  mpm::BoundaryOptions base, left, right;
  base.line_m = {{0, 0}, {4.5 * H, 0}};
  left.line_m = {{0, 0}, {0, 1.2 * H}};
  right.line_m = {{4.5 * H, 0}, {4.5 * H, 1.2 * H}};
  left.type = right.type = mpm::BoundaryType::roller;
  scene.boundaries = {{"base", base}, {"left", left}, {"right", right}};
  mpm::MpmOptions options;
  options.pressure = pressure;
  options.k0 = 0.5;
  options.initial_equilibrium = false;
  options.end_at_rest = false;
  options.energy_limit = 1e9;
  mpm::Solver solver(options, scene, threads);
  SilentProgress silent;
  solver.advance_to(20 * solver.stable_step(), silent);
  const auto steps = solver.steps();
  const double from = solver.time();
  const auto start = std::clock();
  solver.advance_to(from + time, silent);
  return {double(std::clock() - start) / CLOCKS_PER_SEC / time, double(solver.steps() - steps) / time};
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  double time = 0.02, over = 0;
  std::string only;
  int runs = 3, threads = 1;
  for (int a = 1; a < argc; ++a) {
    const std::string word = argv[a];
    if (word.starts_with("seconds=")) time = std::atof(argv[a] + 8);
    else if (word.starts_with("runs=")) runs = std::atoi(argv[a] + 5);
    else if (word.starts_with("threads=")) threads = std::atoi(argv[a] + 8);
    else if (word.starts_with("over=")) over = std::atof(argv[a] + 5);
    else if (word.starts_with("only=")) only = word.substr(5);
  }
  for (const Soil& soil : soils) {
    if (!std::string(soil.name).starts_with(only)) continue;
    std::vector<double> cost[2], ratio;
    double steps[2] = {0, 0};
    for (int r = 0; r < runs; ++r) {
      for (const int k : {0, 1}) {
        const Run run = measure(soil, k == 0 ? mpm::PressureScheme::in_steps : mpm::PressureScheme::projected, time, threads, over);
        cost[k].push_back(run.seconds);
        steps[k] = run.steps;
      }
      ratio.push_back(cost[0].back() / cost[1].back());
    }
    std::printf("%-34s explicit %7.1f s (%6.0f steps), projected %7.1f s (%6.0f steps) a simulated second; %.2f times sooner\n", soil.name,
                median(cost[0]), steps[0], median(cost[1]), steps[1], median(ratio));
    std::fflush(stdout);
  }
  return 0;
}

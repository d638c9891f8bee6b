// A long bed of sand at rest, into which a plate is pressed at one end: the same run without and with sleeping.
//   mpm_sleep [key=value ...]   scheme below (m/s) columns rows speed (of the plate, m/s) end (s) threads
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

using namespace pivnp;

namespace {

constexpr double h = 0.01;  // m

mpm::Scene bed(int columns, int rows, double speed) {
  const double width = columns * h, depth = rows * h;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, columns + 1, rows + 9};
  scene.particles = seed(scene.grid, {{"sand", Polygon({{0, 0}, {width, 0}, {width, depth}, {0, depth}}, "sand")}}, 4,
                         SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions m;
  m.young_pa = 20e6;
  m.density_kg_m3 = 1600;
  m.friction_deg = 35;
  scene.materials = {m};
  mpm::BoundaryOptions base, left, right;
  base.line_m = {{0, 0}, {width, 0}};
  left.line_m = {{0, 0}, {0, depth + 0.08}};
  right.line_m = {{width, 0}, {width, depth + 0.08}};
  left.type = right.type = mpm::BoundaryType::roller;
  scene.boundaries = {{"base", base}, {"left", left}, {"right", right}};
  mpm::RigidOptions plate;
  plate.polygon_m = {{0.05, depth + 0.001}, {0.10, depth + 0.001}, {0.10, depth + 0.03}, {0.05, depth + 0.03}};
  plate.velocity_m_s = {0, -speed};
  scene.bodies = {{"plate", plate}};
  return scene;
}

struct Outcome {
  double s, last;  // processor time; of the last tenth
  MotionFrame frame;
  EnergyRow energy;
  mpm::Solver::Slept slept;
  std::int64_t steps;
};

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> arg{{"scheme", "default"}, {"below", "0.01"}, {"columns", "320"}, {"rows", "20"},
                                         {"speed", "0.05"},     {"end", "0.2"},     {"threads", "1"}};
  for (int a = 1; a < argc; ++a) {
    const std::string text = argv[a];
    arg[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
  const double end = std::stod(arg["end"]);
  SilentProgress silent;
  Outcome outcome[2];
  for (int with = 0; with < 2; ++with) {
    mpm::MpmOptions options;
    options.scheme = value_named<mpm::SchemeName>(arg["scheme"]).value();
    options.k0 = 0.43;
    if (with) options.sleep_below_m_s = std::stod(arg["below"]);
    mpm::Solver solver(options, bed(std::stoi(arg["columns"]), std::stoi(arg["rows"]), std::stod(arg["speed"])),
                       std::stoi(arg["threads"]));
    solver.find_initial_equilibrium(silent);
    if (!with) std::printf("%zu particles, step %.3g s\n", solver.particles().size(), solver.stable_step());
    const auto start = std::clock();
    double last = 0;
    for (int k = 1; k <= 10; ++k) {
      const auto before = std::clock();
      solver.advance_to(end * k / 10, silent);
      last = double(std::clock() - before) / CLOCKS_PER_SEC;
      std::printf("  t %.3f s: %.2f s of processor time, kinetic energy %.3g J/m, %.1f %% left out so far\n",
                  solver.time(), last, solver.energy().kinetic, 100 * solver.slept().share);
      std::fflush(stdout);
    }
    outcome[with] = {double(std::clock() - start) / CLOCKS_PER_SEC, last, solver.frame(), solver.energy(),
                     solver.slept(), solver.steps()};
  }
  double worst = 0, moved = 0;
  for (std::size_t k = 0; k < outcome[0].frame.u.size(); ++k) {
    const auto &a = outcome[0].frame.u[k], &b = outcome[1].frame.u[k];
    worst = std::max(worst, std::hypot(double(a[0] - b[0]), double(a[1] - b[1])));
    moved = std::max(moved, std::hypot(double(a[0]), double(a[1])));
  }
  for (const Outcome& o : outcome) {
    const EnergyRow& e = o.energy;
    std::printf("%.2f s, %lld steps; kinetic %.4g elastic %.4g plastic %.4g damping %.4g contact %.4g ", o.s,
                static_cast<long long>(o.steps), e.kinetic, e.elastic, e.plastic, e.damping, e.contact);
    std::printf("external %.4g residual %.3g J/m\n", e.external, e.residual);
  }
  const Outcome &awake = outcome[0], &asleep = outcome[1];
  std::printf("sleeping: %.2f times as fast, in the last tenth %.1f times; %.1f %% left out, ", awake.s / asleep.s,
              awake.last / asleep.last, 100 * asleep.slept.share);
  std::printf("bound %.3g m, greatest difference %.3g m of %.3g m, %.3g J/m taken\n", asleep.slept.displacement_m, worst,
              moved, asleep.slept.energy);
}

// The elastic column of the peers' comparison, let go under its weight and not damped: where its energy goes, by scheme.
//   mpm_column_energy [cells=50] [steps=8000] [courant=0.2]
// Kinetic energy is given as the mean over eight windows of the run: at one time it is a matter of phase.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

using namespace pivnp;

namespace {

struct Scheme {
  const char *name, *shape, *transfer, *stress, *locking;
};
const Scheme choices[] = {{"bilinear flip musl", "bilinear", "flip", "musl", "none"},
                          {"bilinear flip musl selective", "bilinear", "flip", "musl", "selective"},
                          {"gimp flip musl", "gimp", "flip", "musl", "none"},
                          {"bspline flip musl", "bspline", "flip", "musl", "none"},
                          {"bspline apic usl", "bspline", "apic", "usl", "none"},
                          {"bspline apic usl fbar", "bspline", "apic", "usl", "fbar"}};

mpm::Scene column(int cells) {
  const double h = 1.0 / cells;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, 2 * cells + 1, int(1.2 * cells) + 1};
  scene.particles = seed(scene.grid, {{"soil", Polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, "soil")}}, 4,
                         SeedPattern::even, 0, "per_element");
  mpm::MaterialOptions m;
  m.model = "linear_elastic";
  m.young_pa = 1e6;
  m.density_kg_m3 = 2000;
  scene.materials = {m};
  mpm::BoundaryOptions base, left, right;
  base.line_m = {{0, 0}, {2, 0}};
  left.line_m = {{0, 0}, {0, 1.2}};
  right.line_m = {{2, 0}, {2, 1.2}};
  left.type = right.type = mpm::BoundaryType::roller;
  scene.boundaries = {{"base", base}, {"left", left}, {"right", right}};
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  int cells = 50;
  double steps = 8000, courant = 0.2;
  for (int a = 1; a < argc; ++a) {
    const std::string word = argv[a];
    if (word.starts_with("cells=")) cells = std::atoi(argv[a] + 6);
    if (word.starts_with("steps=")) steps = std::atof(argv[a] + 6);
    if (word.starts_with("courant=")) courant = std::atof(argv[a] + 8);
  }
  constexpr int windows = 8, looks = 40;
  std::printf("%-29s  kinetic, J/m: mean of each eighth of the run | at its end: last  elastic  external  transfer  residual  swing\n", "scheme");
  for (const Scheme& choice : choices) {
    mpm::MpmOptions options;
    options.courant = courant;
    options.shape = value_named<mpm::ShapeKind>(choice.shape);
    options.transfer = value_named<mpm::TransferKind>(choice.transfer);
    options.stress_update = value_named<mpm::StressUpdate>(choice.stress);
    options.locking = value_named<mpm::Locking>(choice.locking);
    options.initial_equilibrium = false;
    options.end_at_rest = false;
    mpm::Solver solver(options, column(cells), 1);
    SilentProgress silent;
    const double end = steps * solver.stable_step();
    std::printf("%-29s ", choice.name);
    double greatest_external = 0;
    for (int w = 0; w < windows; ++w) {
      double mean = 0;
      for (int n = 0; n < looks; ++n) {
        solver.advance_to(end * (w + (n + 1.0) / looks) / windows, silent);
        mean += solver.energy().kinetic / looks;
        greatest_external = std::max(greatest_external, solver.energy().external);
      }
      std::printf(" %6.1f", mean);
      std::fflush(stdout);
    }
    const EnergyRow e = solver.energy();
    std::printf(" | %6.1f %7.1f %7.1f %8.3f %8.3f %7.1f\n", e.kinetic, e.elastic, e.external, e.damping, e.residual,
                greatest_external);
  }
}

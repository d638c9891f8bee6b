#include "apps/study/stress/mpm_stress.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "apps/study/methods/simulation.hpp"
#include "mpm/step/solver.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/seeding.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double right_share = 0.05, wrong_share = 0.2;
constexpr double column_height = 0.4, column_width = 0.3, column_end = 0.35;  // m, m, s

struct Run {
  mpm::MpmOptions options;
  mpm::MaterialOptions sand;
  double cell = column_height / 10;
};

mpm::Scene column_scene(const Run& run) {
  mpm::Scene scene;
  const int nx = int(std::lround(1.4 / run.cell)), ny = int(std::lround(0.6 / run.cell));
  scene.grid = {{0, 0}, {run.cell, run.cell}, nx + 1, ny + 1};
  const Region region{"sand", Polygon({{0, 0}, {column_width, 0}, {column_width, column_height}, {0, column_height}}, "sand")};
  scene.particles = seed(scene.grid, {region}, run.options.per_element, SeedPattern::even, 0.0, "per_element");
  scene.materials = {run.sand};
  mpm::BoundaryOptions base, left;
  base.line_m = {{0, 0}, {nx * run.cell, 0}};
  base.type = mpm::BoundaryType::fixed;
  left.line_m = {{0, 0}, {0, ny * run.cell}};
  left.type = mpm::BoundaryType::roller;
  scene.boundaries = {{"base", base}, {"left", left}};
  return scene;
}

struct Moved {
  std::vector<Vec2> x0, u;
};

Moved moved(const Run& run, int threads) {
  SilentProgress silent;
  mpm::Solver solver(run.options, column_scene(run), threads);
  solver.advance_to(column_end, silent);
  const MotionFrame frame = solver.frame();
  Moved m;
  for (std::size_t k = 0; k < frame.u.size(); ++k) {
    if (!alive(frame.status[k])) continue;
    m.x0.push_back(solver.particles().x0[k]);
    m.u.push_back({double(frame.u[k][0]), double(frame.u[k][1])});
  }
  return m;
}

// Mean displacements over the squares of a lattice that all runs share.
std::map<std::pair<int, int>, Vec2> on_lattice(const Moved& m) {
  constexpr double side = column_height / 10;
  std::map<std::pair<int, int>, std::pair<Vec2, double>> sums;
  for (std::size_t k = 0; k < m.x0.size(); ++k) {
    auto& [sum, n] = sums.try_emplace({int(m.x0[k].x() / side), int(m.x0[k].y() / side)}, Vec2(0, 0), 0.0).first->second;
    sum += m.u[k];
    ++n;
  }
  std::map<std::pair<int, int>, Vec2> means;
  for (const auto& [at, s] : sums) means[at] = s.first / s.second;
  return means;
}

// RMS difference over the greatest displacement of the reference.
double difference_of(const Moved& run, const Moved& reference) {
  const auto a = on_lattice(run), b = on_lattice(reference);
  double square = 0, most = 0;
  for (const auto& [at, u] : b) {
    const auto found = a.find(at);
    square += found == a.end() ? u.squaredNorm() : (found->second - u).squaredNorm();
    most = std::max(most, u.norm());
  }
  return std::sqrt(square / double(b.size())) / most;
}

Run standard_run() {
  Run run;
  run.options.initial_equilibrium = false;
  run.options.end_at_rest = false;
  run.sand.model = "mohr_coulomb";
  run.sand.density_kg_m3 = 1600;
  run.sand.young_pa = 1e6;
  run.sand.poisson = 0.3;
  run.sand.friction_deg = 30;
  return run;
}

struct NamedScheme {
  const char* name;
  mpm::ShapeKind shape;
  const char* transfer;
};
constexpr NamedScheme schemes[] = {{"bilinear, flip", mpm::ShapeKind::bilinear, "flip"},
                                   {"gimp, flip", mpm::ShapeKind::gimp, "flip"},
                                   {"bspline, flip", mpm::ShapeKind::bspline, "flip"},
                                   {"bspline, apic", mpm::ShapeKind::bspline, "apic"}};

struct MpmPlan {
  std::string name, title, label;
  std::vector<double> levels;
  std::vector<TheoryLine> theory;
  std::function<void(Run&, double)> put;
  bool of_reference = false;  // the reference has the level, too: it is part of what is simulated
};

}  // namespace

std::vector<SurvivalMap> mpm_stress(int threads, Progress& progress) {
  const double top = double(std::size(schemes)) - 1;
  const std::vector<MpmPlan> plans = {
      {"mpm_step", "Time step", "time step over the critical one", {0.3, 0.5, 0.7, 0.9, 1, 1.1, 1.2, 1.35, 1.5}, {{"the critical step", {{1, 0}, {1, top}}}},
       [](Run& r, double x) { r.options.courant = x; }, false},
      {"mpm_points", "Material points", "material points per element", {1, 4, 9, 16}, {}, [](Run& r, double x) { r.options.per_element = int(x); }, false},
      {"mpm_poisson", "Bulk stiffness", "Poisson's ratio", {0, 0.3, 0.45, 0.49, 0.499}, {}, [](Run& r, double x) { r.sand.poisson = x; }, true},
      {"mpm_stiffness", "Stiffness", "Young's modulus (Pa)", {2e4, 1e5, 1e6, 1e7}, {}, [](Run& r, double x) { r.sand.young_pa = x; }, true}};
  std::int64_t total = 0, done = 0;
  for (const MpmPlan& plan : plans) total += std::int64_t(plan.levels.size() * (std::size(schemes) + 1));
  std::vector<SurvivalMap> maps;
  for (const MpmPlan& plan : plans) {
    SurvivalMap map;
    map.name = plan.name;
    map.title = plan.title;
    map.made_of = "A column of sand, 0.3 m wide and 0.4 m high on cells of 40 mm, 0.35 s into its collapse; a run a combination. Right: within " +
                  number(100 * right_share) + " % of the greatest displacement, rms, of the default scheme on cells half as large; wrong: more than " +
                  number(100 * wrong_share) + " % without a warning. A run that stops with its reason, or is doubted beforehand, is flagged.";
    map.x = {plan.label, plan.levels, {}};
    map.y.label = "shape functions, transfer";
    for (const NamedScheme& s : schemes) map.y.names.emplace_back(s.name);
    map.theory = plan.theory;
    map.cells.resize(map.x.size() * map.y.size());
    std::optional<Moved> reference;
    for (std::size_t i = 0; i < plan.levels.size(); ++i) {
      progress.update("simulation under stress", done++, total);
      if (!reference || plan.of_reference) {
        Run run = standard_run();
        run.cell /= 2;
        if (plan.of_reference) plan.put(run, plan.levels[i]);
        reference = moved(run, threads);
      }
      for (std::size_t j = 0; j < std::size(schemes); ++j) {
        progress.update("simulation under stress", done++, total);
        if (progress.stop_requested()) throw Interrupted();
        Run run = standard_run();
        run.options.shape = schemes[j].shape;
        run.options.transfer = value_named<mpm::TransferKind>(schemes[j].transfer);
        plan.put(run, plan.levels[i]);
        Survival& cell = map.at(i, j);
        try {
          const double away = difference_of(moved(run, threads), *reference);
          const bool doubted = !doubts(run.options).empty();
          (doubted ? cell.flagged : away < right_share ? cell.good : away <= wrong_share ? cell.fair : cell.wrong) = 1;
          if (!(away <= wrong_share)) cell.wrong_values = 1, cell.wrong_flagged = doubted;
          if (away < right_share) cell.right_values = 1, cell.right_flagged = doubted;
        } catch (const RunError&) {
          cell.flagged = 1;
          cell.wrong_values = cell.wrong_flagged = 1;
        }
      }
    }
    maps.push_back(std::move(map));
  }
  progress.update("simulation under stress", total, total);
  return maps;
}

}  // namespace pivnp::app

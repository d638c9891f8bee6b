// The sand slope of the thesis' section 3.2 as a program: final slope, run-out, energy, wall time.
//   mpm_slope [key=value ...]   phi E c scheme shape transfer update locking damping pic courant base (fixed or a friction) threads end gate per
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "mpm/solver/solver.hpp"
#include "pivnp/core/particles/seeding.hpp"

using namespace pivnp;

namespace {

// fit: angle of a regression of the mass-height profile between 10 and 90 % of the height, degrees; front: x that holds
// 99.5 % of the mass, m; height of the highest column of cells by mass, m.
struct Shape {
  double fit, front99, height;
};

Shape measure(const ParticleSet& set, const MotionFrame& frame, double h) {
  std::map<int, double> column;
  std::vector<std::pair<double, double>> xs;
  double area = 0;
  for (std::size_t k = 0; k < set.size(); ++k) {
    if (frame.status[k] == ParticleStatus::ended) continue;
    const double x = set.x0[k].x() + double(frame.u[k][0]);
    column[int(std::floor(x / h))] += double(set.area[k]) / h;
    xs.emplace_back(x, double(set.area[k]));
    area += double(set.area[k]);
  }
  std::sort(xs.begin(), xs.end());
  double sum = 0, front = 0, highest = 0;
  for (const auto& [x, a] : xs) {
    sum += a;
    if (sum <= 0.995 * area) front = x;
  }
  for (const auto& [i, height] : column) highest = std::max(highest, height);
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [i, height] : column) {
    if (height < 0.1 * highest || height > 0.9 * highest) continue;
    const double x = (i + 0.5) * h;
    n += 1, sx += x, sy += height, sxx += x * x, sxy += x * height;
  }
  const double slope = n > 1 ? (n * sxy - sx * sy) / (n * sxx - sx * sx) : 0;
  return {std::atan(-slope) * 180 / M_PI, front, highest};
}

}  // namespace

int run(int argc, char** argv) {
  std::map<std::string, std::string> arg{{"phi", "43"},    {"E", "30e6"},  {"c", "0"},         {"scheme", "default"},
                                         {"damping", ""},  {"pic", ""},    {"courant", "0.4"}, {"base", "fixed"},
                                         {"threads", "2"}, {"end", "0.5"}, {"gate", "0.02"},   {"per", "4"},
                                         {"psi", "0"},     {"equilibrium", "1"}};
  for (int a = 1; a < argc; ++a) {
    const std::string text = argv[a];
    arg[text.substr(0, text.find('='))] = text.substr(text.find('=') + 1);
  }
  const double h = 0.0075;
  mpm::Scene scene;
  scene.grid = Grid{{0, 0}, {h, h}, 134, 41};
  Region sand{"sand", Polygon({{0, 0}, {0.33, 0}, {0.186, 0.25}, {0, 0.25}}, "sand")};
  scene.particles = seed(scene.grid, {sand}, std::stoi(arg["per"]), SeedPattern::even, 0, "per");
  mpm::MaterialOptions m;
  m.density_kg_m3 = 1545;
  m.young_pa = std::stod(arg["E"]);
  m.poisson = 0.3;
  m.friction_deg = std::stod(arg["phi"]);
  m.dilatancy_deg = std::stod(arg["psi"]);
  m.cohesion_pa = std::stod(arg["c"]);
  scene.materials = {m};
  mpm::BoundaryOptions wall, base, gate;
  wall.line_m = {{0, 0}, {0, 0.3}};
  wall.type = mpm::BoundaryType::roller;
  base.line_m = {{0, 0}, {0.9975, 0}};
  if (arg["base"] != "fixed") {
    base.type = mpm::BoundaryType::frictional;
    base.friction = std::stod(arg["base"]);
  }
  gate.polygon_m = {{0.33, 0}, {0.36, 0}, {0.216, 0.25}, {0.186, 0.25}};
  gate.type = mpm::BoundaryType::roller;
  gate.normal = Pair{std::sin(M_PI / 3), std::cos(M_PI / 3)};
  gate.until_s = std::stod(arg["gate"]);
  scene.boundaries = {{"wall", wall}, {"base", base}, {"gate", gate}};
  mpm::MpmOptions options;
  options.scheme = value_named<mpm::SchemeName>(arg["scheme"]).value();
  options.courant = std::stod(arg["courant"]);
  if (!arg["damping"].empty()) options.damping = std::stod(arg["damping"]);
  const auto choose = [&]<Choice E>(const char* name, std::optional<E>& option) {
    if (!arg[name].empty()) option = value_named<E>(arg[name]).value();
  };
  choose("shape", options.shape);
  choose("transfer", options.transfer);
  choose("update", options.stress_update);
  choose("locking", options.locking);
  if (!arg["pic"].empty()) options.pic_per_s = std::stod(arg["pic"]);

  const auto now = [] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  SilentProgress silent;
  mpm::Solver solver(options, scene, std::stoi(arg["threads"]));
  double t0 = now();
  if (arg["equilibrium"] == "1") solver.find_initial_equilibrium(silent);
  std::printf("particles %zu  equilibrium %.2f s  step %.3g s\n", scene.particles.size(), now() - t0, solver.stable_step());
  t0 = now();
  const double end = std::stod(arg["end"]);
  for (int f = 1; f <= 10; ++f) {
    solver.advance_to(end * f / 10, silent);
    const EnergyRow e = solver.energy();
    std::printf("t %.3f kin %.4g el %.4g pl %.4g damp %.4g cont %.4g ext %.4g res %.4g\n", e.time, e.kinetic, e.elastic,
                e.plastic, e.damping, e.contact, e.external, e.residual);
    std::fflush(stdout);
  }
  const double wall_s = now() - t0;
  const Shape s = measure(solver.particles(), solver.frame(), h);
  std::size_t ended = 0;
  for (const auto st : solver.frame().status) ended += st == ParticleStatus::ended;
  std::printf(
      "slope(fit) %.1f deg  x(99.5 %%) %.3f m  height %.3f  ended %zu  steps %lld  wall %.2f s  %.1f M "
      "particle-steps/s\n",
      s.fit, s.front99, s.height, ended, static_cast<long long>(solver.steps()), wall_s,
      double(solver.steps()) * double(scene.particles.size()) / wall_s / 1e6);
  return 0;
}

int main(int argc, char** argv) try {
  return run(argc, argv);
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 1;
}

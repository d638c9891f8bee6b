#include "apps/study/frontier/mpm/vortex_frontier.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "apps/study/frontier/work.hpp"
#include "mpm/scene/generalised_vortex.hpp"
#include "mpm/scene/options.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/solver.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

constexpr double turning_point = 0.5;  // s
constexpr double usual_cell = 0.05;          // m, cells of the default

struct VortexSetting {
  std::string name, keys;
  mpm::MpmOptions options;
  double cell = usual_cell, across = 2;
  bool standard = false;
};

std::vector<VortexSetting> vortex_settings() {
  mpm::MpmOptions base;
  base.gravity_m_s2 = {0.0, 0.0};
  base.initial_equilibrium = false;
  base.end_at_rest = false;
  base.energy_limit = 1e9;  // what fails here is to be shown
  const mpm::Scheme standard = mpm::scheme_of(base);
  std::vector<VortexSetting> all;
  const auto cells = [](double cell) { return ", cells of " + number(1000 * cell, 3) + " mm"; };
  for (const double cell : {usual_cell, 2 * usual_cell, usual_cell / 2})
    for (const mpm::ShapeRow& shape : mpm::shapes())
      for (const mpm::TransferRow& transfer : mpm::transfers()) {
        if (transfer.value != transfer.runs() || shape.value != shape.runs()) continue;
        VortexSetting s{std::string(shape.name) + ", " + std::string(transfer.name) + cells(cell),
                  "mpm.shape=" + std::string(shape.name) + " mpm.transfer=" + std::string(transfer.name), base, cell, 2, false};
        s.options.shape = shape.value;
        s.options.transfer = transfer.value;
        const bool usual = shape.value == standard.shape && transfer.value == standard.transfer;
        if (cell < usual_cell && !usual) continue;  // the order of the default alone
        s.standard = cell == usual_cell && usual;
        all.push_back(std::move(s));
      }
  const auto add = [&](const std::string& name, const std::string& keys, std::optional<double> courant, double across) {
    VortexSetting s{"default, " + name + cells(usual_cell), keys, base, usual_cell, across, false};
    s.options.courant = courant;
    all.push_back(std::move(s));
  };
  for (const int k : {1, 3, 4}) add(std::to_string(k * k) + (k == 1 ? " point" : " points"), "mpm.per_element=" + std::to_string(k * k), base.courant, k);
  for (const double courant : {0.2, 0.4, 0.8}) add("step " + number(courant, 2) + " of the critical", "mpm.courant=" + number(courant, 2), courant, 2);
  return all;
}

}  // namespace

FrontierStage vortex_frontier(int repeats, int threads, Progress& progress) {
  const mpm::GeneralisedVortex motion(1, 1e3);
  FrontierStage stage;
  stage.name = "vortex";
  stage.title = "Simulation: generalised vortex";
  stage.made_of = "A neo-Hookean ring (0.75 to 1.25 m) turned by up to one radian, by a body force for which the motion is known; at the turning point.";
  stage.error_label = "displacement, rms error (m)";
  stage.time_label = "time of a run (s)";
  stage.columns = {{"cell_m", "cell (m)", "side of a cell"}, {"greatest_m", "greatest (m)", "greatest error of any material point"},
                   {"points", "points", "material points"}, {"steps", "steps", "time steps"}};
  const std::vector<VortexSetting> all = vortex_settings();
  SilentProgress unseen;
  std::vector<Timed> timed;  // as stage.points
  for (std::size_t k = 0; k < all.size(); ++k) {
    const VortexSetting& s = all[k];
    progress.update("vortex", std::int64_t(k), std::int64_t(all.size()));
    if (progress.stop_requested()) throw Interrupted();
    FrontierPoint p;
    p.name = s.name, p.keys = s.keys, p.standard = s.standard;
    double square = 0, area = 0, greatest = 0, steps = 0;
    std::size_t points = 0;
    const auto turned = [&motion, &s, threads, &unseen](const auto& score) {
      const mpm::Scene scene = motion.scene(s.cell, s.across);
      mpm::Solver solver(s.options, scene, threads);
      solver.advance_to(turning_point, unseen);
      score(scene, solver);
    };
    const auto score = [&](const mpm::Scene& scene, const mpm::Solver& solver) {
      const MotionFrame last = solver.frame();
      const std::vector<Vec2>& X = scene.particles.x0;
      for (std::size_t q = 0; q < X.size(); ++q) {
        const double miss = (X[q] + Vec2(double(last.u[q][0]), double(last.u[q][1])) - motion.position(X[q])).norm();
        square += scene.particles.area[q] * miss * miss, area += scene.particles.area[q];
        greatest = std::max(greatest, miss);
      }
      points = X.size();
      steps = double(solver.steps());
    };
    try {
      const Effort work = measured(threads, [&] { turned(score); });
      timed.push_back({{work.seconds}, [turned, threads] { return seconds_of(threads, [&] { turned([](const mpm::Scene&, const mpm::Solver&) {}); }); }});
      p.bytes = work.bytes, p.instructions = work.instructions;
      p.error = std::sqrt(square / area);
      p.columns = {s.cell, greatest, double(points), steps};
      stage.points.push_back(std::move(p));
    } catch (const RunError& error) {
      stage.left_out.push_back(s.name + ": " + error.what());
    }
  }
  repeat_in_turn(timed, repeats, progress);
  for (std::size_t k = 0; k < timed.size(); ++k) set_times(timed[k].seconds, stage.points[k]);
  find_front(stage.points);
  const auto error_of = [&](double cell) {
    const auto at = std::find_if(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& p) {
      return p.columns[0] == cell && std::any_of(stage.points.begin(), stage.points.end(), [&](const FrontierPoint& d) { return d.standard && d.keys == p.keys; });
    });
    return at == stage.points.end() ? std::nan("") : at->error;
  };
  const double coarse = error_of(2 * usual_cell), middle = error_of(usual_cell), finest = error_of(usual_cell / 2);
  if (std::isfinite(coarse) && std::isfinite(middle) && std::isfinite(finest))
    stage.remarks.push_back("Observed order of the default in the cell: " + number(std::log2(coarse / middle), 2) + " from " + number(2000 * usual_cell, 3) + " to " +
                            number(1000 * usual_cell, 3) + " mm, " + number(std::log2(middle / finest), 2) + " from there to " + number(500 * usual_cell, 3) + " mm.");
  return stage;
}

}  // namespace pivnp::app

#include "apps/study/methods/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "apps/study/methods/simulation/doubts.hpp"
#include "apps/study/pipeline/scene/simulation_scene.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

namespace {

// The steps to the next state as steps to the end.
class StepsToTheEnd final : public Progress {
 public:
  StepsToTheEnd(Progress& progress, const mpm::Solver& solver, const char* what, double end)
      : progress_(progress), solver_(solver), what_(what), end_(end) {}
  void update(std::string_view, std::int64_t done, std::int64_t total) override {
    const double beyond = std::max(0.0, end_ - next) / solver_.stable_step();
    progress_.update(what_, done, total + (beyond < 1e15 ? std::int64_t(std::ceil(beyond)) : 0));
  }
  bool stop_requested() const override { return progress_.stop_requested(); }

  double next = 0;  // the time of the next state

 private:
  Progress& progress_;
  const mpm::Solver& solver_;
  const char* what_;
  double end_;
};

struct Simulated {
  mpm::Solver::Slept slept;
  std::string pressure_choice;
};

// All states into the record; nothing where they were there before.
std::optional<Simulated> advance(const Case& c, const Setting& setting, const std::string& motion, const std::vector<double>& times,
                                 io::RecordWriter& writer, int threads, Progress& progress, const char* what) {
  const std::string stage = "motion/" + motion;
  const io::StageState done = writer.stage(stage);
  if (done.complete) return std::nullopt;
  mpm::Solver solver = make_solver(c, setting, threads);
  std::size_t next = done.items;
  if (next == 0 && c.mpm->initial_equilibrium) solver.find_initial_equilibrium(progress);
  writer.begin_motion(motion, solver.particles());
  if (next > 0) solver.load(done.checkpoint);
  StepsToTheEnd steps(progress, solver, what, times.back());
  for (std::size_t k = next; k < times.size(); ++k) {
    steps.next = times[k];
    solver.advance_to(times[k], steps);
    const MotionFrame frame = solver.frame();
    writer.add_frame(motion, frame);
    if (motion == "mpm") {
      writer.add_energy(motion, solver.energy());
      if (const auto names = solver.reaction_names(); !names.empty()) writer.add_reactions(motion, names, solver.reactions());
    }
    if (writer.segment_full(stage)) writer.close_segment(stage, solver.save());
  }
  progress.update(what, solver.steps(), solver.steps());
  writer.end_stage(stage, &solver.particles());
  return Simulated{solver.slept(), solver.pressure_choice()};
}

}  // namespace

std::vector<Remark> simulate(const Case& c, const Setting& setting, const std::vector<double>& times,
                                  io::RecordWriter& writer, int threads, Progress& progress) {
  const std::optional<Simulated> run = advance(c, setting, "mpm", times, writer, threads, progress, "simulation");
  if (!run) return {};
  std::vector<Remark> notes;
  for (std::string& doubt : doubts(c, setting)) notes.push_back({std::move(doubt), RemarkWeight::doubt});
  if (!run->pressure_choice.empty()) notes.push_back({run->pressure_choice});
  if (c.mpm->sleep_below_m_s)
    notes.push_back({"Sleeping left out " + number(100 * run->slept.share, 3) +
                    " % of the particles' steps. While asleep no particle missed more than " + number(run->slept.displacement_m, 2) +
                    " m of displacement, and " + number(run->slept.energy, 2) + " J/m of kinetic energy was removed (part of damping)."});
  return notes;
}

Grid coarsened(const Grid& grid, double factor) {
  const auto nodes = [&](int count) { return int(std::ceil((count - 1) / factor - 1e-9)) + 1; };
  return {grid.origin, factor * grid.spacing, nodes(grid.nx), nodes(grid.ny)};
}

void simulate_coarser(const Case& c, const Setting& setting, int level, const std::vector<double>& times,
                      io::RecordWriter& writer, int threads, Progress& progress) {
  Setting coarse = setting;
  coarse.grid = coarsened(setting.grid, std::pow(mesh_study_ratio, level));
  advance(c, coarse, coarser_motion(level), times, writer, threads, progress, "coarser grid");
}

}  // namespace pivnp::app

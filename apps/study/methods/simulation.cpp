#include "apps/study/methods/simulation.hpp"

#include "apps/study/pipeline/simulation_scene.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::app {

std::vector<std::string> simulate(const Case& c, const Setting& setting, const std::vector<double>& times,
                                  io::RecordWriter& writer, int threads, Progress& progress) {
  const std::string stage = "motion/mpm";
  const io::StageState done = writer.stage(stage);
  if (done.complete) return {};
  mpm::Solver solver = make_solver(c, setting, threads);
  std::size_t next = done.items;
  writer.begin_motion("mpm", solver.particles());
  if (next > 0)
    solver.load(done.checkpoint);
  else if (c.mpm->initial_equilibrium)
    solver.find_initial_equilibrium(progress);
  for (std::size_t k = next; k < times.size(); ++k) {
    solver.advance_to(times[k], progress);
    writer.add_frame("mpm", solver.frame());
    writer.add_energy("mpm", solver.energy());
    if (const auto names = solver.reaction_names(); !names.empty()) writer.add_reactions("mpm", names, solver.reactions());
    if (writer.segment_full(stage)) writer.close_segment(stage, solver.save());
    progress.update("simulation", std::int64_t(k), std::int64_t(times.size()) - 1);
  }
  writer.end_stage(stage, &solver.particles());
  std::vector<std::string> notes;
  if (!solver.pressure_choice().empty()) notes.push_back(solver.pressure_choice());
  if (!c.mpm->sleep_below_m_s) return notes;
  const mpm::Solver::Slept slept = solver.slept();
  notes.push_back("Sleeping left out " + number(100 * slept.share, 3) +
                  " % of the particles' steps. While asleep no particle missed more than " + number(slept.displacement_m, 2) +
                  " m of displacement, and " + number(slept.energy, 2) + " J/m of kinetic energy was taken (part of damping).");
  return notes;
}

}  // namespace pivnp::app

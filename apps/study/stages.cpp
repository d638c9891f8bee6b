#include "apps/study/stages.hpp"

#include "mpm/solver.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

void track(const Case& c, const Setting& setting, const std::vector<Frame>& frames, io::RecordWriter& writer,
           Progress& progress) {
  const std::string stage = "motion/np";
  const io::StageState done = writer.stage(stage);
  if (done.complete) return;
  np::Tracker tracker(c.np.value_or(np::NpOptions{}), seed_particles(c, setting), frames.front().time);
  std::size_t next = done.items;  // the next frame to write
  writer.begin_motion("np", tracker.particles());
  if (next > 0) {
    tracker.load(done.checkpoint);
  } else {
    writer.add_frame("np", tracker.frame());
    next = 1;
  }
  for (std::size_t k = next; k < frames.size(); ++k) {
    if (progress.stop_requested()) throw Interrupted();
    tracker.step(writer.pair(k - 1), frames[k].time);
    writer.add_frame("np", tracker.frame());
    if (writer.segment_full(stage)) writer.close_segment(stage, tracker.save());
    progress.update("numerical particles", std::int64_t(k), std::int64_t(frames.size()) - 1);
  }
  writer.end_stage(stage, &tracker.particles());
}

void simulate(const Case& c, const Setting& setting, const std::vector<double>& times, io::RecordWriter& writer,
              int threads, Progress& progress) {
  const std::string stage = "motion/mpm";
  const io::StageState done = writer.stage(stage);
  if (done.complete) return;
  mpm::Solver solver(*c.mpm, make_scene(c, setting, *c.mpm, c.materials, "material."), threads);
  std::size_t next = done.items;
  writer.begin_motion("mpm", solver.particles());
  if (next > 0)
    solver.load(done.checkpoint);
  else if (c.mpm->settle)
    solver.settle(progress);
  for (std::size_t k = next; k < times.size(); ++k) {
    solver.advance_to(times[k], progress);
    writer.add_frame("mpm", solver.frame());
    writer.add_energy("mpm", solver.energy());
    if (writer.segment_full(stage)) writer.close_segment(stage, solver.save());
    progress.update("simulation", std::int64_t(k), std::int64_t(times.size()) - 1);
  }
  writer.end_stage(stage, &solver.particles());
}

}  // namespace pivnp::app

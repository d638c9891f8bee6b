#include "apps/study/stages.hpp"

#include <algorithm>
#include <limits>

#include "mpm/solver.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/np/reseed.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

ParticleSet all_particles(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                          const std::function<VectorField(std::size_t)>& pair, Progress& progress) {
  ParticleSet all = seed_particles(c, setting);
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  if (!options.reseed) return all;
  np::Tracker scout(options, all, frames.front().time);
  np::Reseeder reseeder(setting.grid, options.per_element,
                        options.seeding == "gauss" ? SeedPattern::gauss : SeedPattern::even, scout);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (progress.stop_requested()) throw Interrupted();
    const VectorField field = pair(k - 1);
    scout.step(field, frames[k].time);
    const ParticleSet born = reseeder.births(scout, field);
    if (born.size() > 0) scout.add(born);
    progress.update("births", std::int64_t(k), std::int64_t(frames.size()) - 1);
  }
  all = scout.particles();
  std::fill(all.end.begin(), all.end.end(), std::numeric_limits<double>::quiet_NaN());
  std::fill(all.end_reason.begin(), all.end_reason.end(), EndReason::none);
  return all;
}

std::vector<DriftRound> follow(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                               const Measured& measured, int threads, Progress& progress,
                               const std::function<void(std::size_t frame, const np::Tracker&)>& at_frame) {
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  np::Tracker tracker(options, all_particles(c, setting, frames, measured.pair, progress), frames.front().time);
  DriftCorrector corrector(c, setting, threads);
  if (options.drift != "none") corrector.start(tracker, measured.image(0).view());
  at_frame(0, tracker);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    if (progress.stop_requested()) throw Interrupted();
    tracker.step(measured.pair(k - 1), frames[k].time);
    if (options.drift != "none")
      corrector.after_step(tracker, int(k), k + 1 == frames.size(), [&] { return measured.image(int(k)); });
    at_frame(k, tracker);
    progress.update("numerical particles", std::int64_t(k), std::int64_t(frames.size()) - 1);
  }
  return corrector.rounds();
}

std::vector<DriftRound> track(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                              image::FrameSource& source, io::RecordWriter& writer, int threads, Progress& progress) {
  const std::string stage = "motion/np";
  const io::StageState done = writer.stage(stage);
  if (done.complete) return {};
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  const auto pair = [&](std::size_t k) { return writer.pair(k); };
  np::Tracker tracker(options, all_particles(c, setting, frames, pair, progress), frames.front().time);
  writer.begin_motion("np", tracker.particles());
  const auto write = [&](std::size_t k, const np::Tracker& now) {
    if (k < done.items) return;
    writer.add_frame("np", now.frame());
    if (writer.segment_full(stage)) writer.close_segment(stage, now.save());
  };
  if (options.drift != "none") {
    const Measured measured{pair, [&](int k) { return source.read(k); }};
    ParticleSet ends;
    const auto rounds = follow(c, setting, frames, measured, threads, progress,
                               [&](std::size_t k, const np::Tracker& now) {
                                 write(k, now);
                                 if (k + 1 == frames.size()) ends = now.particles();
                               });
    writer.end_stage(stage, &ends);
    return rounds;
  }
  std::size_t next = done.items;  // the next frame to write
  if (next > 0) {
    tracker.load(done.checkpoint);
  } else {
    writer.add_frame("np", tracker.frame());
    next = 1;
  }
  for (std::size_t k = next; k < frames.size(); ++k) {
    if (progress.stop_requested()) throw Interrupted();
    tracker.step(writer.pair(k - 1), frames[k].time);
    write(k, tracker);
    progress.update("numerical particles", std::int64_t(k), std::int64_t(frames.size()) - 1);
  }
  writer.end_stage(stage, &tracker.particles());
  return {};
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

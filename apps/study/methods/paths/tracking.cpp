#include "apps/study/methods/paths/tracking.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "apps/study/methods/paths/unseen_error.hpp"
#include "apps/study/pipeline/measure/material_masks.hpp"
#include "apps/study/pipeline/measure/measure.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/np/errors/bend_loss.hpp"
#include "pivnp/np/reseed.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

std::vector<TrackStep> plan_steps(const std::vector<Frame>& frames) {
  constexpr int most = 4;  // flagged steps in a row that one longer step replaces
  const auto lost = [&](int to) { return (frames[std::size_t(to)].flag & frame_decorrelated) != 0; };
  const int count = int(frames.size());
  std::vector<TrackStep> steps;
  for (int from = 0; from + 1 < count;) {
    int to = from + 1;
    while (to < count && lost(to)) ++to;
    const int run = to - from - 1;  // flagged steps from here on
    if (run >= 2 && run <= most)
      steps.push_back({from, from + run});
    else
      for (int k = from; k < std::max(from + run, from + 1); ++k) steps.push_back({k, k + 1});
    from = steps.back().to;
  }
  return steps;
}

ParticleSet all_particles(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                          const Measured& measured, Progress& progress) {
  ParticleSet all = seed_particles(c, setting);
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  if (!options.reseed) return all;
  np::Tracker scout(options, all, frames.front().time);
  np::Reseeder reseeder(setting.grid, options.per_element, options.seeding, scout);
  for (const TrackStep& step : measured.steps) {
    if (progress.stop_requested()) throw Interrupted();
    const VectorField field = measured.field(step);
    scout.step(field, frames[std::size_t(step.to)].time);
    const ParticleSet born = reseeder.births(scout, field);
    if (born.size() > 0) scout.add(born);
    progress.update("births", step.to, std::int64_t(frames.size()) - 1);
  }
  all = scout.particles();
  std::fill(all.end.begin(), all.end.end(), std::numeric_limits<double>::quiet_NaN());
  std::fill(all.end_reason.begin(), all.end_reason.end(), EndReason::none);
  return all;
}

namespace {

// Pairs whose correlations were averaged have one error in common: of the path of m of them it is m times theirs, its
// variance m^2 times, to which the m-th adds 2 m - 1.
void repeat_error(int before, VectorField& field) {
  if (before == 0) return;
  const auto times = static_cast<float>(2 * before + 1);
  for (auto& cov : field.cov)
    for (float& entry : cov) entry *= times;
}

int ensemble_of(const Case& c) { return c.piv.value_or(piv::PivOptions{}).ensemble; }

int window_of(const Case& c) { return c.piv.value_or(piv::PivOptions{}).window_px; }

// Particles, and what is known of them beside their state.
struct Followed {
  np::Tracker tracker;
  np::BendLoss lost;
  Followed(const np::NpOptions& options, ParticleSet particles, double start)
      : tracker(options, std::move(particles), start), lost(tracker.particles().size()) {}
};

// All steps from where the tracker stands.
void go_on(Followed& followed, DriftCorrector* corrector, const Case& c, const Setting& setting,
           const std::vector<Frame>& frames, const Measured& measured, std::size_t done, Progress& progress,
           const std::function<void(std::size_t step, const np::Tracker&)>& at_step) {
  np::Tracker& tracker = followed.tracker;
  const int ensemble = setting.imported ? 1 : ensemble_of(c);
  const double per_px = setting.grid.spacing.x() / node_spacing_px(setting), window = window_of(c) * per_px;
  for (std::size_t n = done; n < measured.steps.size(); ++n) {
    if (progress.stop_requested()) throw Interrupted();
    const TrackStep& step = measured.steps[n];
    VectorField field = measured.field(step);
    add_repeated(measured.closure, int(n) + 1, field);
    repeat_error(step.from % ensemble, field);
    followed.lost.before_step(tracker);
    tracker.step(field, frames[std::size_t(step.to)].time);
    followed.lost.after_step(tracker, field, setting.imported ? 0 : np::BendLoss::length_of(field, window));
    if (corrector != nullptr)
      corrector->after_step(tracker, followed.lost, step.to, n + 1 == measured.steps.size(),
                            paths_alike(field, window) / per_px, [&] { return measured.image(step.to); });
    at_step(n + 1, tracker);
    progress.update("numerical particles", step.to, std::int64_t(frames.size()) - 1);
  }
}

// The vectors of the longer pairs, and the steps as they will be taken.
struct Bridges {
  std::vector<TrackStep> steps, bridged;
  std::vector<VectorField> fields;  // of `bridged`
};

Bridges bridge(const Case& c, const Setting& setting, const std::vector<Frame>& frames, image::FrameSource& source,
               const io::RecordWriter& writer, int threads, MaterialMasks& material) {
  Bridges b;
  std::vector<double> valid;
  const std::vector<TrackStep> planned = plan_steps(frames);
  if (planned.size() + 1 < frames.size())
    for (std::size_t k = 0; k + 1 < frames.size(); ++k) valid.push_back(quality_of(writer.pair(k)).valid);
  std::sort(valid.begin(), valid.end());
  for (const TrackStep& step : planned) {
    if (step.to - step.from > 1) {
      VectorField field = measure_pair(c, setting, source, {step.from, step.to}, threads, &material);
      if (const StepQuality q = quality_of(field); !q.lost() && q.valid >= 0.5 * valid[valid.size() / 2]) {
        b.bridged.push_back(step);
        b.fields.push_back(std::move(field));
      } else {
        for (int k = step.from; k + 1 < step.to; ++k) b.steps.push_back({k, k + 1});
        b.steps.push_back({step.to - 1, step.to});
        continue;
      }
    }
    b.steps.push_back(step);
  }
  return b;
}

}  // namespace

std::vector<DriftRound> follow(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                               const Measured& measured, int threads, Progress& progress,
                               const std::function<void(std::size_t step, const np::Tracker&)>& at_step) {
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  Followed followed(options, all_particles(c, setting, frames, measured, progress), frames.front().time);
  DriftCorrector corrector(c, setting, threads);
  if (options.drift != np::DriftScheme::none)
    corrector.start(followed.tracker, followed.lost, measured.image(0).view());
  at_step(0, followed.tracker);
  go_on(followed, &corrector, c, setting, frames, measured, 0, progress, at_step);
  return corrector.rounds();
}

TrackOutcome track(const Case& c, const Setting& setting, const std::vector<Frame>& frames, image::FrameSource* source,
                   const ClosureNote& closure, io::RecordWriter& writer, int threads, Progress& progress) {
  const std::string stage = "motion/np";
  const io::StageState done = writer.stage(stage);
  if (done.complete) return {};
  const np::NpOptions options = c.np.value_or(np::NpOptions{});
  Bridges bridges;
  MaterialMasks material(c, setting, [&](int k) { return writer.pair(std::size_t(k)); });
  if (setting.imported)
    for (int k = 0; k + 1 < int(frames.size()); ++k) bridges.steps.push_back({k, k + 1});
  else
    bridges = bridge(c, setting, frames, *source, writer, threads, material);
  const Measured measured{bridges.steps,
                          [&](const TrackStep& step) {
                            const auto at = std::find(bridges.bridged.begin(), bridges.bridged.end(), step);
                            return at == bridges.bridged.end()
                                       ? writer.pair(std::size_t(step.from))
                                       : bridges.fields[std::size_t(at - bridges.bridged.begin())];
                          },
                          [&](int k) { return prepared(setting, source->read(k)); }, closure};
  TrackOutcome outcome;
  outcome.bridged = bridges.bridged;
  Followed followed(options, all_particles(c, setting, frames, measured, progress), frames.front().time);
  np::Tracker& tracker = followed.tracker;
  writer.begin_motion("np", tracker.particles());
  const auto write = [&](std::size_t step, const np::Tracker& now) {
    if (step < done.items) return;
    writer.add_frame("np", now.frame());
    if (!writer.segment_full(stage)) return;
    std::vector<std::byte> state = now.save();
    followed.lost.save(state);
    writer.close_segment(stage, state);
  };
  const bool corrected = options.drift != np::DriftScheme::none;
  DriftCorrector corrector(c, setting, threads);
  if (corrected) corrector.start(tracker, followed.lost, prepared(setting, source->read(0)).view());
  const bool resumed = !corrected && done.items > 0;
  if (resumed) {
    std::vector<std::byte> state = done.checkpoint;
    followed.lost.load(state);
    tracker.load(state);
  } else {
    write(0, tracker);
  }
  go_on(followed, corrected ? &corrector : nullptr, c, setting, frames, measured, resumed ? done.items - 1 : 0,
        progress, write);
  writer.end_stage(stage, &tracker.particles());
  outcome.rounds = corrector.rounds();
  return outcome;
}

std::vector<std::string> remarks_on_tracking(const TrackOutcome& tracked, const std::vector<Frame>& frames) {
  std::vector<std::string> remarks;
  for (const TrackStep& step : tracked.bridged)
    remarks.push_back("Between " + frames[std::size_t(step.from)].name + " and " + frames[std::size_t(step.to)].name +
                      (step.to - step.from == 2 ? " a frame was" : " frames were") +
                      " dropped, as no vectors there can be trusted; the particles continue with the longer pair.");
  const std::vector<DriftRound>& rounds = tracked.rounds;
  if (rounds.empty()) return remarks;
  std::size_t alive = 0, first = 0, later = 0;
  const DriftRound* worst = nullptr;
  for (const DriftRound& r : rounds) {
    alive += r.alive;
    first += r.from_first;
    later += r.from_later;
    if (worst == nullptr || r.median_px > worst->median_px) worst = &r;
  }
  const auto share = [&](std::size_t n) {
    return number(100 * double(n) / double(std::max<std::size_t>(1, alive)), 3) + " %";
  };
  remarks.push_back(
         "Drift: direct correlation in " + std::to_string(rounds.size()) + " frames held " + share(first) +
          " of the particles to the first frame and " + share(later) +
          " to a later one; the others went on by their increments. Greatest median correction: " +
          number(worst->median_px, 2) + " px, at frame " + std::to_string(worst->frame) + ".");
  return remarks;
}

}  // namespace pivnp::app

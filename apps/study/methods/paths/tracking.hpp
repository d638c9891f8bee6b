// Numerical particles through the measured vectors, into the record; able to go on from its last closed segment.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/methods/paths/closure.hpp"
#include "apps/study/methods/paths/drift.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// One step of tracking: from one frame to a later one, the next as a rule.
struct TrackStep {
  int from = 0, to = 1;
  bool operator==(const TrackStep&) const = default;
};

/// Steps from frame to frame, past dropped ones: where two to four steps in a row are flagged decorrelated, the frames
/// between them are bad (blank, blurred, torn), and one longer step bridges them. A single flagged step stays.
std::vector<TrackStep> plan_steps(const std::vector<Frame>& frames);

/// What tracking reads: its steps, their vectors, and a frame where drift correction asks for it.
struct Measured {
  std::vector<TrackStep> steps;
  std::function<VectorField(const TrackStep&)> field;
  std::function<Image(int)> image;
  ClosureNote closure = {};  // its repeated error goes into the covariance of the paths
};

/// The particles of a run: those of the first frame and, with np.reseed, those born later, found by tracking once
/// through all steps beforehand.
ParticleSet all_particles(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                          const Measured& measured, Progress& progress);

/// Numerical particles through every step, held against drift as np.drift says. `at_step` sees the tracker at the start
/// (0) and after every step (1 ...). Returns the rounds of direct correlation.
std::vector<DriftRound> follow(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                               const Measured& measured, int threads, Progress& progress,
                               const std::function<void(std::size_t step, const np::Tracker&)>& at_step);

struct TrackOutcome {
  std::vector<DriftRound> rounds;
  std::vector<TrackStep> bridged;  // steps over dropped frames
};

/// The same into the record: motion "np", without a time for dropped frames. A bridging pair is correlated here; it is
/// used if at least half the usual share of its vectors is valid, else the frames are tracked one by one, as they are
/// where the vectors are another program's. `source`: nullptr where there are none, and drift is not held. Goes on from
/// the last closed segment; where drift is corrected, what is already written is tracked again (the same bits) and not
/// written.
TrackOutcome track(const Case& c, const Setting& setting, const std::vector<Frame>& frames, image::FrameSource* source,
                   const ClosureNote& closure, io::RecordWriter& writer, int threads, Progress& progress);

/// Dropped frames, and what drift correction came to.
std::vector<std::string> remarks_on_tracking(const TrackOutcome& tracked, const std::vector<Frame>& frames);

}  // namespace pivnp::app

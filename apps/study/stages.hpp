// The stages after PIV, each into the record and able to go on from its last closed segment.
#pragma once

#include <functional>
#include <vector>

#include "apps/study/drift.hpp"
#include "apps/study/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// What tracking reads: the vectors of pair k (frames k and k + 1), and a frame where drift correction asks for it.
struct Measured {
  std::function<VectorField(std::size_t)> pair;
  std::function<Image(int)> image;
};

/// The particles of a run: those of the first frame and, with np.reseed, those born later, found by tracking once through
/// all pairs beforehand.
ParticleSet all_particles(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                          const std::function<VectorField(std::size_t)>& pair, Progress& progress);

/// Numerical particles through every pair, held against drift as np.drift says. `at_frame` sees the tracker at every
/// frame, the first included. Returns the rounds of direct correlation.
std::vector<DriftRound> follow(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                               const Measured& measured, int threads, Progress& progress,
                               const std::function<void(std::size_t frame, const np::Tracker&)>& at_frame);

/// The same into the record: motion "np". Goes on from the last closed segment; where drift is corrected, what is
/// already written is tracked again (the same bits) and not written.
std::vector<DriftRound> track(const Case& c, const Setting& setting, const std::vector<Frame>& frames,
                              image::FrameSource& source, io::RecordWriter& writer, int threads, Progress& progress);

/// The simulation at `times` (the first is 0): motion "mpm", and its energy.
void simulate(const Case& c, const Setting& setting, const std::vector<double>& times, io::RecordWriter& writer,
              int threads, Progress& progress);

}  // namespace pivnp::app

// The PIV stage: frames through the correlator, vectors to the world, pair by pair into the record.
#pragma once

#include <string>
#include <vector>

#include "apps/study/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// What one pair's vectors say of the pair as a whole.
struct PairQuality {
  double valid = 0;         // share of the vectors asked for (not masked) that are valid
  double median_score = 0;  // of all that have one
  double median_shift = 0;  // of |displacement| over the valid, grid spacings
};
PairQuality quality_of(const VectorField& field);

/// Measures every pair that `writer` does not hold yet; at most two frames are in memory.
void measure(const Case& c, const Setting& setting, image::FrameSource& source, io::RecordWriter& writer, int threads,
             Progress& progress);

/// Frame flags from all pairs: a step is decorrelated if it lost most of what its fellows kept, repeated if nothing
/// moved in it while its fellows moved.
std::vector<Frame> flagged_frames(std::vector<Frame> frames, const io::RecordWriter& writer);

}  // namespace pivnp::app

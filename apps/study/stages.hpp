// The stages after PIV, each into the record and able to go on from its last closed segment.
#pragma once

#include <vector>

#include "apps/study/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// Numerical particles through every pair: motion "np".
void track(const Case& c, const Setting& setting, const std::vector<Frame>& frames, io::RecordWriter& writer,
           Progress& progress);

/// The simulation at `times` (the first is 0): motion "mpm", and its energy.
void simulate(const Case& c, const Setting& setting, const std::vector<double>& times, io::RecordWriter& writer,
              int threads, Progress& progress);

}  // namespace pivnp::app

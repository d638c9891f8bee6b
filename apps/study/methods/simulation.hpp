// The simulation of a case, into the record; able to go on from its last closed segment.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// The simulation at `times` (the first is 0): motion "mpm", and its energy. Returns remarks: what sleeping left out.
std::vector<std::string> simulate(const Case& c, const Setting& setting, const std::vector<double>& times,
                                  io::RecordWriter& writer, int threads, Progress& progress);

}  // namespace pivnp::app

// What is read off a run's record.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/study/sweep/sweep.hpp"

namespace pivnp::app {

/// Fills responses, times, distance and speed of `run` from its record. Throws InputError.
void read_responses(const Case& c, const SweepOptions& options, SweepRun& run, Progress& progress);

/// The particles' places and a field at the last output time; NaN where the record lacks it.
struct LastField {
  std::vector<Vec2> x;
  std::vector<double> half;  // half an edge of a particle's square
  std::vector<double> values;
};
LastField last_field(const std::filesystem::path& record, const std::string& field);

}  // namespace pivnp::app

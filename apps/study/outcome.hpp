// What a finished run tells: remarks on what was flagged, and the comparison as the record keeps it.
#pragma once

#include <string>
#include <vector>

#include "apps/study/stages.hpp"
#include "apps/study/study.hpp"
#include "compare/compare.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// What was flagged in a record and why, one sentence each: flagged steps, ended particles.
std::vector<std::string> remarks_of(const io::RecordReader& record);

/// Dropped frames, and what drift correction came to.
std::vector<std::string> remarks_on_tracking(const TrackOutcome& tracked, const std::vector<Frame>& frames);

/// The residual of the camera's targets becomes the measurement's systematic uncertainty where none is given.
void add_camera(double residual, compare::CompareOptions& options);

io::ComparisonData comparison_data(const compare::Comparison& comparison, const std::string& first,
                                   const std::string& second, const std::string& time_unit);

/// The case that stands for a comparison of two sources given by hand.
Case comparison_case(const CompareSources& sources, const compare::CompareOptions& options,
                     const compare::LimitOptions& limits);

struct Compared {
  std::string first, second, time_unit;  // names of the sides
};
/// The common end of such a comparison: into the record, which is finished, and into the report.
RunOutcome finish_comparison(const Case& c, const Compared& sides, compare::Comparison comparison,
                             io::RecordWriter& writer, const RunSettings& settings);

}  // namespace pivnp::app

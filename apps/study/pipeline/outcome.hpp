// What a finished run tells: remarks on what was flagged, and the comparison as the record keeps it.
#pragma once

#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "pivnp/io/record.hpp"

namespace pivnp::app {

/// What was flagged in a record and why, one sentence each: flagged steps, ended particles.
std::vector<std::string> remarks_of(const io::RecordReader& record);

/// The residual of the camera's targets becomes the measurement's systematic uncertainty where none is given.
void add_camera(double residual, compare::CompareOptions& options);

io::ComparisonData comparison_data(const compare::Comparison& comparison, const std::string& first,
                                   const std::string& second, const std::string& time_unit);

}  // namespace pivnp::app

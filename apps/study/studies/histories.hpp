// Comparing curves: fronts against time, from tables or from a motion.
#pragma once

#include <string>

#include "apps/study/studies/comparison.hpp"

namespace pivnp::app {

/// True for "FORMAT=FILE[:COLUMN]" with a FORMAT that reads curves (history; pivnp/io/imports/import_format.hpp) and
/// "front=RECORD[:motion]", "front_left=RECORD[:motion]".
bool is_history(const std::string& text);

/// Compares two histories; options of scale, shift (its x), time scale and offset act on the second. Writes a record
/// with the metrics history_* and both curves, and its report.
RunOutcome compare_histories(const CompareSources& sources, const compare::CompareOptions& options,
                             const compare::LimitOptions& limits, const RunSettings& settings);

}  // namespace pivnp::app

// Two sources given by hand: what is compared, and how such a comparison ends.
#pragma once

#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "compare/compare.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

/// What is compared, each "RECORD.h5" or "RECORD.h5:motion" (a record with one motion needs no name), or results of
/// another program (pivnp/io/imports/import_motion.hpp), or both of them histories (studies/histories.hpp).
struct CompareSources {
  std::string first, second;
  std::vector<std::string> coarser;  // the second on coarser grids, the finer one first
  double refinement_ratio = 2;       // of the grids' spacings
  double step_s = 1;                 // time from one step to the next where files only count them
  std::string length_unit = "m";     // of other programs' results
};

/// The case that stands for a comparison of two sources given by hand.
Case comparison_case(const CompareSources& sources, const compare::CompareOptions& options,
                     const compare::LimitOptions& limits);

/// The common end of such a comparison: into the record, which is finished, and into the report.
RunOutcome finish_comparison(const Case& c, Comparison comparison, io::RecordWriter& writer,
                             const RunSettings& settings);

}  // namespace pivnp::app

// Commands on finished records: compare two of them, report one again.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "apps/study/studies/comparison.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/exports/exports.hpp"

namespace pivnp::app {

/// Compares two motions, writes a record with both and the comparison, and its report.
RunOutcome compare_records(const CompareSources& sources, const compare::CompareOptions& options,
                           const compare::LimitOptions& limits, const RunSettings& settings, Progress& progress);

/// Writes the report of a finished record beside it (or into settings.out). `change`: what is to be drawn otherwise than
/// the record's case says.
RunOutcome report_record(const std::filesystem::path& record, const RunSettings& settings, Progress& progress,
                         const std::function<void(report::ReportOptions&)>& change = {});

/// Writes fields of a finished record into `out` (empty: export/ beside it), in one of the formats. Returns the files.
std::vector<std::filesystem::path> export_record(const std::filesystem::path& record, const std::filesystem::path& out, io::ExportFormat format,
                                                 const io::ExportOptions& options);

}  // namespace pivnp::app

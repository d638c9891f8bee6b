// The report: one self-contained HTML, one PDF, and its figures as PNG and SVG, drawn offscreen.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/content/content.hpp"
#include "apps/report/content/options.hpp"
#include "compare/data/options.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::report {

struct ReportInput {
  std::string name;
  const io::RecordReader* record = nullptr;
  std::optional<Comparison> comparison;  // left out: the metrics and fields that the record holds
  compare::CompareOptions compared;      // what the comparison was told: motions are drawn as it sees them
  std::vector<Picture> pictures;         // frames to draw vectors on, one at least if there is PIV
  std::shared_ptr<const Picture> last_picture;  // the frame at the last compared time, if it is to be had (nullptr: it is not)
  std::vector<std::pair<std::string, std::string>> setup;  // of the measurement: what, and how it was
  std::vector<std::pair<std::string, std::string>> simulated;  // of the simulation, likewise
  std::vector<Run> runs;                 // to show beside each other, this record's own first
  std::vector<Remark> remarks;           // what the run and its data say: doubts are flags
  std::vector<std::string> notes;        // how the comparison was made, likewise
};

/// What the report is made from. `input.record` and the pictures must outlive it. Throws InputError "report.data_sets: ..."
/// where the record lacks a motion that is asked for.
Content content_of(const ReportOptions& options, const ReportInput& input);

/// Writes report.html, report.pdf and figures/*.png, *.svg into `directory`. Throws RunError if it cannot.
void write_report(const ReportOptions& options, const ReportInput& input, const std::filesystem::path& directory);

}  // namespace pivnp::report

#include "apps/study/pipeline/report_input.hpp"

#include <algorithm>

#include "apps/report/report.hpp"
#include "apps/study/pipeline/outcome.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::app {

namespace {

namespace fs = std::filesystem;

// The pictures under vectors: the frames nearest to the report's times, at most three, never one twice; without images
// where there is no source of them.
std::vector<report::Picture> pictures(const Case& c, const io::RecordReader& record, image::FrameSource* source) {
  const std::vector<Frame>& frames = record.frames();
  std::vector<double> times = c.report.times_s;
  if (times.empty())
    for (const double share : {1.0 / 3, 2.0 / 3}) times.push_back(share * frames.back().time);
  std::vector<int> chosen;
  for (const double t : times) {
    const auto nearest = std::min_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) {
      return std::abs(a.time - t) < std::abs(b.time - t);
    });
    const int index = std::min(int(nearest - frames.begin()), int(frames.size()) - 2);  // the first of a pair
    if (std::find(chosen.begin(), chosen.end(), index) == chosen.end()) chosen.push_back(index);
  }
  std::sort(chosen.begin(), chosen.end());
  if (chosen.size() > 3) chosen.resize(3);
  std::vector<report::Picture> out;
  for (const int index : chosen) out.push_back({index, source ? source->read(index) : Image()});
  return out;
}

}  // namespace

void write_report_of(const Case& c, RunOutcome& outcome, std::optional<Comparison> comparison,
                     image::FrameSource* source, const fs::path& directory) {
  const io::RecordReader record(outcome.record, io::Trust::known);  // just written, or read before
  report::ReportInput input;
  input.name = c.name;
  input.record = &record;
  input.remarks = outcome.remarks;
  if (comparison) {
    input.notes = comparison->remarks;
    outcome.remarks.insert(outcome.remarks.end(), comparison->remarks.begin(), comparison->remarks.end());
  }
  input.comparison = std::move(comparison);
  input.compared = c.compare;
  if (record.pair_count() > 0) input.pictures = pictures(c, record, source);
  report::write_report(c.report, input, directory);
  outcome.report_html = directory / "report.html";
  outcome.report_pdf = directory / "report.pdf";
  const std::vector<std::string> flagged = remarks_of(record);  // the report finds these itself
  outcome.remarks.insert(outcome.remarks.end(), flagged.begin(), flagged.end());
}

}  // namespace pivnp::app

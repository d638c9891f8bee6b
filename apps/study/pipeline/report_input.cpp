#include "apps/study/pipeline/report_input.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "apps/report/report.hpp"
#include "apps/study/pipeline/outcome.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
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

// Rows of the report's table on how the measurement was made: what the case says.
std::vector<std::pair<std::string, std::string>> setup_of(const Case& c, const io::RecordReader& record) {
  std::vector<std::pair<std::string, std::string>> rows;
  if (record.pair_count() == 0) return rows;
  const std::vector<Frame>& frames = record.frames();
  std::string text = std::to_string(frames.size());
  if (record.head().time_unit == "s" && frames.size() > 1)
    text += ", " + number(double(frames.size() - 1) / (frames.back().time - frames.front().time), 4) + " a second";
  rows.emplace_back("Frames", text);
  if (c.vectors) {
    rows.emplace_back("Correlation", "another program's vectors (" + c.vectors->format + ")");
  } else {
    const piv::PivOptions piv = c.piv.value_or(piv::PivOptions{});
    rows.emplace_back("Correlation", piv.method + ", " + std::string(name_of(piv.smoothing)) + " smoothing, " + std::string(name_of(piv.anchor)) +
                                         " vectors, frame to frame");
    const double h_px = c.grid.spacing_px.value_or(piv.window_px / 2.0);
    rows.emplace_back("Subset or window", std::to_string(piv.window_px) + " px" +
                                              (c.grid.spacing_m ? std::string() : ", overlap " + number(100 * std::max(0.0, 1 - h_px / piv.window_px), 3) + " %"));
    rows.emplace_back("Interpolant of the images", "quintic B-spline");
    rows.emplace_back("Validation", "normalised median " + number(piv.median_threshold) + ", score above " + number(piv.min_score) +
                                        ", stated error below " + number(piv.max_sigma_px) + " px");
  }
  const np::NpOptions np = c.np.value_or(np::NpOptions{});
  rows.emplace_back("Particles", std::to_string(np.per_element) + " an element, shape functions " + std::string(name_of(np.shape)) + ", drift " +
                                     std::string(name_of(np.drift)));
  return rows;
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
  input.setup = setup_of(c, record);
  if (record.pair_count() > 0) {
    input.pictures = pictures(c, record, source);
    const std::vector<double> times = input.comparison ? input.comparison->times() : std::vector<double>{};
    if (source && !times.empty()) {
      const std::vector<Frame>& frames = record.frames();
      const auto nearest = std::min_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) {
        return std::abs(a.time - times.back()) < std::abs(b.time - times.back());
      });
      const int index = int(nearest - frames.begin());
      input.last_picture = std::make_shared<report::Picture>(report::Picture{index, source->read(index)});
    }
  }
  report::write_report(c.report, input, directory);
  outcome.report_html = directory / "report.html";
  outcome.report_pdf = directory / "report.pdf";
  const std::vector<std::string> flagged = remarks_of(record);  // the report finds these itself
  outcome.remarks.insert(outcome.remarks.end(), flagged.begin(), flagged.end());
}

}  // namespace pivnp::app

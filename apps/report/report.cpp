#include "apps/report/report.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "apps/report/write.hpp"

namespace pivnp::report {

namespace {

// A stored comparison lacks the outlines and the shares of partners; what it holds is enough for tables and fields.
compare::Comparison from_record(const io::ComparisonData& data) {
  compare::Comparison c;
  c.metrics = data.metrics;
  for (const io::ComparisonData::Field& f : data.fields) {
    if (c.id.empty()) {
      c.id = f.id;
      c.time = f.time;
    }
    if (f.id == c.id && f.time == c.time) c.fields.push_back({f.name, f.unit, f.definition, f.values});
  }
  for (const io::ComparisonData::Table& t : data.tables) {
    compare::ColumnTable& table = c.tables.emplace_back();
    table.name = t.name;
    table.definition = t.definition;
    for (const io::ComparisonData::Table::Column& column : t.columns)
      table.columns.push_back({column.name, column.unit, column.values});
  }
  c.over_limit =
      std::any_of(c.metrics.begin(), c.metrics.end(), [](const Metric& m) { return m.verdict == "over limit"; });
  return c;
}

// Which motion is the measured one: the comparison says so; else the customary names; else the order in the record.
std::pair<std::string, std::string> sides(const std::vector<std::string>& names,
                                          const std::optional<io::ComparisonData>& stored) {
  auto known = [&](const std::string& n) { return std::find(names.begin(), names.end(), n) != names.end(); };
  if (stored && known(stored->measured) && known(stored->simulated)) return {stored->measured, stored->simulated};
  std::string measured = known("np") ? "np" : "", simulated = known("mpm") ? "mpm" : "";
  for (const std::string& n : names) {
    if (n == measured || n == simulated) continue;
    if (measured.empty()) measured = n;
    else if (simulated.empty()) simulated = n;
  }
  return {measured, simulated};
}

}  // namespace

void write_report(const ReportOptions& options, const ReportInput& input, const std::filesystem::path& directory) {
  const io::RecordReader& record = *input.record;
  const io::RecordHead& head = record.head();
  const std::optional<io::ComparisonData> stored = record.comparison();

  Content content;
  content.name = input.name;
  content.command = head.command;
  content.case_text = head.case_text;
  content.length_unit = head.length_unit;
  content.time_unit = head.time_unit;
  content.world_from_pixel = head.world_from_pixel;
  content.camera_residual = head.camera_residual;
  content.frames = record.frames();
  content.pair_count = record.pair_count();
  content.pair = [&record](std::size_t k) { return record.pair(k); };
  const auto [measured, simulated] = sides(record.motion_names(), stored);
  if (!measured.empty()) {
    content.measured = record.motion(measured);
    content.strain_note = record.strain_note(measured);
  }
  if (!simulated.empty()) content.simulated = record.motion(simulated);
  if (input.comparison) content.comparison = input.comparison;
  else if (stored) content.comparison = from_record(*stored);
  content.energy = record.energy();
  content.pictures = input.pictures;
  content.remarks = input.remarks;
  write_content(options, content, directory);
}

}  // namespace pivnp::report

#include "apps/report/report.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/write.hpp"
#include "compare/alignment/as_compared.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/gauge.hpp"

namespace pivnp::report {

namespace {

// Which motion is the measured one: the comparison says so; else the customary names; else the order in the record.
std::pair<std::string, std::string> compared_motions(const std::vector<std::string>& names,
                                                     const std::optional<Comparison>& stored) {
  auto known = [&](const std::string& n) { return std::find(names.begin(), names.end(), n) != names.end(); };
  if (stored && known(stored->names[0]) && known(stored->names[1])) return {stored->names[0], stored->names[1]};
  std::string measured = known("np") ? "np" : "", simulated = known("mpm") ? "mpm" : "";
  for (const std::string& n : names) {
    if (n == measured || n == simulated) continue;
    if (measured.empty()) measured = n;
    else if (simulated.empty()) simulated = n;
  }
  return {measured, simulated};
}

// One or two motions by name: the first takes the measurement's place.
std::pair<std::string, std::string> asked_motions(const std::vector<std::string>& names, const std::vector<std::string>& asked) {
  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
  if (asked.size() > 2) throw InputError("report.data_sets: found " + std::to_string(asked.size()) + " names, expected one or two");
  for (const std::string& name : asked)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw InputError("report.data_sets: found '" + name + "', expected motions of the record (" + known + ")");
  if (asked.size() == 1) return asked[0] == "mpm" ? std::pair(std::string(), asked[0]) : std::pair(asked[0], std::string());
  return {asked[0], asked[1]};
}

std::vector<std::pair<std::string, std::string>> hardware_rows(const HardwareOptions& hardware) {
  std::vector<std::pair<std::string, std::string>> rows;
  HardwareOptions::fields(hardware, [&](std::string_view name, const std::string& text, const OptionInfo&) {
    if (text.empty()) return;
    std::string words(name);
    std::replace(words.begin(), words.end(), '_', ' ');
    words[0] = char(std::toupper(static_cast<unsigned char>(words[0])));
    rows.emplace_back(std::move(words), text);
  });
  return rows;
}

// What a reader must know of how the motions are drawn.
std::string alignment_words(const compare::CompareOptions& o, const Comparison& comparison, bool first_as_it_is,
                            bool second_as_it_is) {
  if (first_as_it_is && second_as_it_is) return "";
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  if (!o.fixed_zone_m.empty()) add("without the shift and rotation of compare.fixed_zone_m");
  else if (!o.reference_m.empty()) add("without the mean motion of compare.reference_m");
  if (const Metric* offset = find(comparison.metrics, "time_offset"); offset != nullptr || o.time_offset_s != 0)
    add("the second " + plot::plain(o.time_offset_s + (offset != nullptr ? offset->value : 0)) + " " +
        "later than on its own clock");
  if (find(comparison.metrics, "coordinate_shift_x") != nullptr) add("the second laid on the first's outline");
  return "Drawn as compared: " + (text.empty() ? std::string("counted from the common start, at common times") : text) + ".";
}

}  // namespace

Content content_of(const ReportOptions& options, const ReportInput& input) {
  const io::RecordReader& record = *input.record;
  const io::RecordHead& head = record.head();
  const std::optional<Comparison> stored = record.comparison();

  Content content;
  content.name = input.name;
  content.command = head.command;
  content.written_by = record.written_by();
  content.case_text = head.case_text;
  content.length_unit = head.length_unit;
  content.time_unit = head.time_unit;
  content.world_from_pixel = head.world_from_pixel;
  content.camera_residual = head.camera_residual;
  content.camera_motion = record.camera_motion();
  content.frames = record.frames();
  content.pair_count = record.pair_count();
  content.pair = [&record](std::size_t k) { return record.pair(k); };
  const auto compared = compared_motions(record.motion_names(), stored);
  const auto [measured, simulated] = options.data_sets.empty() ? compared : asked_motions(record.motion_names(), options.data_sets);
  if (!measured.empty()) {
    content.measured = record.motion(measured);
    content.strain_note = record.strain_note(measured);
  }
  if (!simulated.empty()) content.simulated = record.motion(simulated);
  content.tracked = content.measured;
  if (std::pair(measured, simulated) == compared) content.comparison = input.comparison ? input.comparison : stored;
  if (content.comparison && content.measured && content.simulated) {
    const compare::ComparedMotions seen = compare::as_compared(content.measured, content.simulated, input.compared);
    content.alignment = alignment_words(input.compared, *content.comparison, seen.first == content.measured,
                                        seen.second == content.simulated);
    content.measured = seen.first;
    content.simulated = seen.second;
  }
  if (options.gauge_m) {
    content.gauge = options.gauge_m;
    if (content.measured) content.measured = with_gauge(content.measured, *options.gauge_m);
    if (content.simulated) content.simulated = with_gauge(content.simulated, *options.gauge_m);
  }
  if (input.compared.mobilised_m) content.mobilised = *input.compared.mobilised_m;
  else if (content.comparison)
    if (const Metric* peak = find(content.comparison->metrics, "displacement_peak_first")) content.mobilised = 0.05 * peak->value;
  content.hardware = hardware_rows(options.hardware);
  content.setup = input.setup;
  content.simulated_setup = input.simulated;
  content.runs = input.runs;
  content.last_picture = input.last_picture;
  content.per_radian = record.head().per_radian;
  content.energy = record.energy();
  content.cost = record.cost();
  content.reactions = record.reactions();
  content.pictures = input.pictures;
  content.remarks = input.remarks;
  content.notes = input.notes;
  return content;
}

void write_report(const ReportOptions& options, const ReportInput& input, const std::filesystem::path& directory) {
  write_content(options, content_of(options, input), directory);
}

}  // namespace pivnp::report

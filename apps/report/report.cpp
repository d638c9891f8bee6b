#include "apps/report/report.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "apps/report/write.hpp"
#include "compare/alignment/as_compared.hpp"

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

Content content_of(const ReportInput& input) {
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
  content.frames = record.frames();
  content.pair_count = record.pair_count();
  content.pair = [&record](std::size_t k) { return record.pair(k); };
  const auto [measured, simulated] = compared_motions(record.motion_names(), stored);
  if (!measured.empty()) {
    content.measured = record.motion(measured);
    content.strain_note = record.strain_note(measured);
  }
  if (!simulated.empty()) content.simulated = record.motion(simulated);
  content.tracked = content.measured;
  content.comparison = input.comparison ? input.comparison : stored;
  if (content.comparison && content.measured && content.simulated) {
    const compare::ComparedMotions seen = compare::as_compared(content.measured, content.simulated, input.compared);
    content.alignment = alignment_words(input.compared, *content.comparison, seen.first == content.measured,
                                        seen.second == content.simulated);
    content.measured = seen.first;
    content.simulated = seen.second;
  }
  content.energy = record.energy();
  content.reactions = record.reactions();
  content.pictures = input.pictures;
  content.remarks = input.remarks;
  content.notes = input.notes;
  return content;
}

void write_report(const ReportOptions& options, const ReportInput& input, const std::filesystem::path& directory) {
  write_content(options, content_of(input), directory);
}

}  // namespace pivnp::report

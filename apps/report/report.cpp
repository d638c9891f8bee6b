#include "apps/report/report.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "apps/report/write.hpp"

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

}  // namespace

void write_report(const ReportOptions& options, const ReportInput& input, const std::filesystem::path& directory) {
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
  content.comparison = input.comparison ? input.comparison : stored;
  content.energy = record.energy();
  content.reactions = record.reactions();
  content.pictures = input.pictures;
  content.remarks = input.remarks;
  write_content(options, content, directory);
}

}  // namespace pivnp::report

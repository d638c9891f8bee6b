#include <cmath>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/instruction_set.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/records/record_impl.hpp"

namespace pivnp::io {

namespace {

constexpr int most_nodes = 1'000'000'000;

void write_sources(h5::OutputFile& file, const std::vector<FileIdentity>& sources) {
  std::vector<std::string> names, hashes;
  std::vector<std::int64_t> sizes;
  for (const FileIdentity& source : sources) {
    names.push_back(source.name);
    sizes.push_back(static_cast<std::int64_t>(source.size));
    hashes.push_back(source.hash);
  }
  file.group("/source");
  file.write_texts("/source/name", names);
  file.write("/source/size", sizes, "");
  file.write_texts("/source/hash", hashes);
}

std::vector<FileIdentity> read_sources(const h5::Source& source) {
  std::vector<FileIdentity> out;
  if (!source.has("/source")) return out;
  const std::vector<std::string> names = source.texts("/source/name"), hashes = source.texts("/source/hash");
  const h5::Dataset size = source.dataset("/source/size");
  size.expect({names.size()});
  const std::vector<std::int64_t> sizes = size.all<std::int64_t>();
  if (hashes.size() != names.size())
    throw InputError(source.name() + ": /source/hash: has " + std::to_string(hashes.size()) + " texts, expected " +
                     std::to_string(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k)
    out.push_back({names[k], static_cast<std::uint64_t>(sizes[k]), hashes[k]});
  return out;
}

}  // namespace

std::string difference_of_cases(const std::string& there, const std::string& now) {
  if (there == now) return "";
  std::istringstream a(there), b(now);
  std::string line_a, line_b;
  for (int number = 1;; ++number) {
    const bool has_a = bool(std::getline(a, line_a)), has_b = bool(std::getline(b, line_b));
    if (!has_a && !has_b) return "in the line ends";
    if (has_a && has_b && line_a == line_b) continue;
    const auto quoted = [](bool has, const std::string& line) {
      return has ? "'" + line + "'" : std::string("nothing");
    };
    return "first in line " + std::to_string(number) + ": " + quoted(has_a, line_a) + " there, " +
           quoted(has_b, line_b) + " now";
  }
}

void write_head(h5::OutputFile& file, const RecordHead& head, const std::string& created) {
  file.attribute("/", "schema", schema_name);
  file.attribute("/", "schema_version", schema_version);
  file.attribute("/", "command", head.command);
  file.attribute("/", "created", created);
  file.attribute("/", "version", build_info().version);
  file.attribute("/", "commit", build_info().commit);
  file.attribute("/", "libraries", build_info().libraries);
  file.attribute("/", "instruction_set", instruction_set());
  file.attribute("/", "length_unit", head.length_unit);
  file.attribute("/", "time_unit", head.time_unit);
  if (head.per_radian) file.attribute("/", "geometry", "axisymmetric");
  file.write_text("/case", head.case_text);
  file.group("/grid");
  file.attribute("/grid", "origin", head.grid.origin.data(), {2});
  file.attribute("/grid", "spacing", head.grid.spacing.data(), {2});
  file.attribute("/grid", "nodes", std::vector<std::int64_t>{head.grid.nx, head.grid.ny});
  file.attribute("/grid", "unit", head.length_unit);
  file.group("/camera");
  if (head.metres_per_pixel) file.attribute("/camera", "metres_per_pixel", *head.metres_per_pixel);
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = head.world_from_pixel;
  file.attribute("/camera", "world_from_pixel", rows.data(), {3, 3});
  if (!head.distortion.empty())
    file.attribute("/camera", "distortion", head.distortion.data(), {head.distortion.size()});
  if (!head.focal.empty()) {
    file.attribute("/camera", "lens", head.lens);
    file.attribute("/camera", "focal", head.focal.data(), {head.focal.size()});
    file.attribute("/camera", "principal", head.principal.data(), {head.principal.size()});
  }
  if (!head.window.empty()) file.attribute("/camera", "window", head.window.data(), {head.window.size()});
  file.attribute("/camera", "residual", head.camera_residual);
  file.attribute("/camera", "unit", head.length_unit);
  if (!head.sources.empty()) write_sources(file, head.sources);
}

BuildInfo read_written_by(const h5::Source& source) {
  const auto text = [&](const char* name) {
    return source.has_attribute("/", name) ? source.attribute_text("/", name) : std::string();
  };
  return {text("version"), text("commit"), text("libraries")};
}

RecordHead read_head(const h5::Source& source) {
  RecordHead head;
  head.command = source.attribute_text("/", "command");
  head.length_unit = source.attribute_text("/", "length_unit");
  head.time_unit = source.attribute_text("/", "time_unit");
  head.per_radian = source.has_attribute("/", "geometry") && source.attribute_text("/", "geometry") == "axisymmetric";
  const std::vector<std::string> text = source.texts("/case");
  head.case_text = text.empty() ? "" : text[0];
  const auto numbers = [&](const char* object, const char* name, std::size_t count) {
    std::vector<double> values = source.attribute_numbers(object, name);
    if (values.size() != count)
      throw InputError(source.name() + ": " + object + ": attribute '" + name + "' has " +
                       std::to_string(values.size()) + " numbers, expected " + std::to_string(count));
    return values;
  };
  head.grid.origin = Vec2(numbers("/grid", "origin", 2).data());
  head.grid.spacing = Vec2(numbers("/grid", "spacing", 2).data());
  const std::vector<double> nodes = numbers("/grid", "nodes", 2);
  const bool no_grid = nodes[0] == 0 && nodes[1] == 0;  // a comparison of histories, say
  for (const double n : nodes)
    if (!no_grid && (!(n >= 1 && n <= most_nodes) || n != std::floor(n) || nodes[0] * nodes[1] > most_nodes))
      throw InputError(source.name() + ": /grid: attribute 'nodes' is " + std::to_string(nodes[0]) + ", " +
                       std::to_string(nodes[1]) + ", expected two whole numbers whose product is 1 to " +
                       std::to_string(most_nodes));
  head.grid.nx = static_cast<int>(nodes[0]);
  head.grid.ny = static_cast<int>(nodes[1]);
  for (const double h : {head.grid.spacing.x(), head.grid.spacing.y()})
    if (!no_grid && (!(h > 0) || !std::isfinite(h) || !head.grid.origin.allFinite()))
      throw InputError(source.name() + ": /grid: spacing " + std::to_string(h) + " or the origin is no length, expected " +
                       "finite numbers, spacings above 0");
  if (source.has_attribute("/camera", "metres_per_pixel"))
    head.metres_per_pixel = source.attribute_number("/camera", "metres_per_pixel");
  head.world_from_pixel =
      Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(numbers("/camera", "world_from_pixel", 9).data());
  if (source.has_attribute("/camera", "distortion"))
    head.distortion = source.attribute_numbers("/camera", "distortion");
  if (source.has_attribute("/camera", "focal")) {
    head.lens = source.attribute_text("/camera", "lens");
    head.focal = numbers("/camera", "focal", 2);
    head.principal = numbers("/camera", "principal", 2);
  }
  if (source.has_attribute("/camera", "window")) head.window = numbers("/camera", "window", 3);
  head.camera_residual = source.attribute_number("/camera", "residual");
  head.sources = read_sources(source);
  return head;
}

void check_same_program(const BuildInfo& there, const std::string& where) {
  const BuildInfo& now = build_info();
  const auto check = [&](const char* what, const std::string& a, const std::string& b) {
    if (a != b)
      throw InputError(where + ": another program began the run to resume, with " + what + " " + shown(a) + "; this one has " +
                       b + "; run without --resume to start again");
  };
  check("version", there.version, now.version);
  check("commit", there.commit, now.commit);
  check("libraries", there.libraries, now.libraries);
}

void check_same_instruction_set(const h5::Source& source, const std::string& where) {
  const std::string there =
      source.has_attribute("/", "instruction_set") ? source.attribute_text("/", "instruction_set") : std::string();
  const std::string now = instruction_set();
  if (there != now)
    throw InputError(where + ": the run to resume began with the instruction set " + shown(there) + "; this one has " + now +
                     ", whose results differ by round-off; add --simd " + shown(there) +
                     " (on a processor that has it), or run without --resume to start again");
}

void check_same_case(const RecordHead& there, const RecordHead& now, const std::string& where, const StageKeys& keys, const std::string& stage) {
  const auto text = [&](const RecordHead& head) { return keys ? keys(head.case_text, stage) : head.case_text; };
  const std::string difference = difference_of_cases(text(there), text(now));
  if (!difference.empty())
    throw InputError(where + ": the case differs from that of the run to resume, " + difference + "; run without --resume to start again");
}

void check_same_run(const RecordHead& there, const RecordHead& now, const std::string& where, const StageKeys& keys) {
  const std::string advice = "; run without --resume to start again";
  check_same_case(there, now, where, keys, "piv");
  // Records of before 1.3 do not tell; they are finished.
  const std::string file = there.sources.empty() ? "" : first_difference(there.sources, now.sources);
  if (!file.empty())
    throw InputError(where + ": the frames (or masks) are not those of the run to resume: " + file + advice);
  if (!(there.grid == now.grid))
    throw InputError(where +
                     ": the grid differs from that of the run to resume, though the case is the same (other frames?)" +
                     advice);
  if (there.world_from_pixel != now.world_from_pixel || there.length_unit != now.length_unit ||
      there.time_unit != now.time_unit)
    throw InputError(where +
                     ": the camera or the units differ from those of the run to resume, though the case is the same" +
                     advice);
}

}  // namespace pivnp::io

#include "pivnp/io/records/record_check.hpp"

#include <cstdlib>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

namespace {

constexpr int first_with_checksum = 3;  // version 1.3

int minor_of(const std::string& version) {
  const std::size_t dot = version.find('.');
  return dot == std::string::npos ? 0 : std::atoi(version.c_str() + dot + 1);
}

}  // namespace

bool is_record(const fs::path& path) {
  if (fs::is_directory(path)) return fs::exists(path / "record.h5") && !fs::exists(path / "case.toml");
  if (path.extension() == ".h5") return true;
  if (!fs::is_regular_file(path)) return false;
  char beginning[8] = {};
  open_regular_file(path).read(beginning, sizeof beginning);
  return std::string_view(beginning, sizeof beginning) == "\x89HDF\r\n\x1a\n";
}

RecordCheck check_record(const fs::path& path) {
  const fs::path file = fs::is_directory(path) ? path / "record.h5" : path;
  const RecordReader reader(file);
  RecordCheck check;
  check.has_checksum = seal_of(file) == Seal::intact;
  if (const std::string version = reader.schema_version(); !check.has_checksum && minor_of(version) >= first_with_checksum)
    throw InputError(file.string() + ": not as it was written: damaged, or changed by another program: it has no valid " +
                     "checksum, expected one in a record of version " + version);
  check.bytes = fs::file_size(file);
  if (const BuildInfo by = reader.written_by(); !by.version.empty()) check.written_by = by.version + " (" + by.commit + ")";
  check.frames = reader.frames().size();
  check.pairs = reader.pair_count();
  for (std::size_t k = 0; k < check.pairs; ++k) reader.pair(k);
  reader.camera_motion();
  reader.closure();
  reader.remarks();
  for (const std::string& name : reader.motion_names()) {
    const auto motion = reader.motion(name);
    check.motions.push_back({name, motion->particles().size(), motion->times().size()});
    for (std::size_t k = 0; k < motion->times().size(); ++k) motion->frame(k);
    reader.strain_note(name);
  }
  reader.energy();
  reader.reactions();
  reader.comparison();
  return check;
}

}  // namespace pivnp::io

#include "pivnp/io/records/record_check.hpp"

#include <fstream>
#include <string_view>

#include "pivnp/io/files/seal.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

bool is_record(const fs::path& path) {
  if (fs::is_directory(path)) return fs::exists(path / "record.h5") && !fs::exists(path / "case.toml");
  if (path.extension() == ".h5") return true;
  char beginning[8] = {};
  std::ifstream(path, std::ios::binary).read(beginning, sizeof beginning);
  return std::string_view(beginning, sizeof beginning) == "\x89HDF\r\n\x1a\n";
}

RecordCheck check_record(const fs::path& path) {
  const fs::path file = fs::is_directory(path) ? path / "record.h5" : path;
  const RecordReader reader(file);
  RecordCheck check;
  check.has_checksum = seal_of(file) == Seal::intact;
  check.bytes = fs::file_size(file);
  if (const BuildInfo by = reader.written_by(); !by.version.empty()) check.written_by = by.version + " (" + by.commit + ")";
  check.frames = reader.frames().size();
  check.pairs = reader.pair_count();
  for (std::size_t k = 0; k < check.pairs; ++k) reader.pair(k);
  reader.closure();
  for (const std::string& name : reader.motion_names()) {
    const auto motion = reader.motion(name);
    check.motions.push_back({name, motion->particles().size(), motion->times().size()});
    for (std::size_t k = 0; k < motion->times().size(); ++k) motion->frame(k);
    reader.strain_note(name);
  }
  reader.energy();
  reader.comparison();
  return check;
}

}  // namespace pivnp::io

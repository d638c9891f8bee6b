// Is a record whole?
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pivnp::io {

struct RecordCheck {
  bool has_checksum = false;  // else it is of a version before 1.3
  std::string written_by;     // "0.1.0 (v0.1-3-gabc)"; empty: the record does not say
  std::uintmax_t bytes = 0;
  std::size_t frames = 0, pairs = 0;
  struct Motion {
    std::string name;
    std::size_t particles = 0, times = 0;
  };
  std::vector<Motion> motions;
};

/// True for HDF5 files, for files called *.h5 whatever they hold, and for folders with a record.h5 but no case.toml.
bool is_record(const std::filesystem::path& path);

/// Reads all of a record (or of FOLDER/record.h5): its checksum, its structure, every pair, frame and table. Throws InputError
/// of one line that names file and fault; a record of version 1.3 or later without a valid checksum is one, whoever changed it.
RecordCheck check_record(const std::filesystem::path& path);

}  // namespace pivnp::io

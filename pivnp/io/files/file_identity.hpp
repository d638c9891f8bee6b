// By what a file is known again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/progress.hpp"

namespace pivnp::io {

/// The same name, size and hash: the same content (by accident, 1 in 2^64 differs).
struct FileIdentity {
  std::string name;
  std::uint64_t size = 0;
  std::string hash;  // XXH64 of the whole content, 16 hexadecimal digits

  bool operator==(const FileIdentity&) const = default;
};

/// Reads the whole file. `name`: what it is to be called. `progress` is asked between blocks whether to stop. Throws
/// InputError if the file cannot be read, Interrupted.
FileIdentity identity_of(const std::filesystem::path& file, std::string name, const Progress& progress = SilentProgress());

/// What differs first between files as they were and as they are now ("frame_00003.png has other content"), or empty.
std::string first_difference(const std::vector<FileIdentity>& there, const std::vector<FileIdentity>& now);

}  // namespace pivnp::io

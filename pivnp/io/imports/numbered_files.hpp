// Files that count steps in their names. Private to this folder's sources.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pivnp::io {

/// The files of a pattern (a file, or a glob in one folder) by the last number in their names. Throws InputError where
/// there is none, or a name without a number.
std::map<std::int64_t, std::vector<std::filesystem::path>> numbered_files(const std::string& pattern);

}  // namespace pivnp::io

// Files that are there whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace pivnp::plot {

/// Makes the folder and its parents. Throws RunError naming it and the cause.
void make_folder(const std::filesystem::path& folder);

/// Writes beside `file` under a temporary name, syncs, and renames. Throws RunError naming the file and the cause; what
/// was there before is then untouched.
void write_file(const std::filesystem::path& file, std::string_view bytes);

}  // namespace pivnp::plot

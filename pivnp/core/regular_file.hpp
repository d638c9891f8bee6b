// The one way to files that are read: a pipe would wait for its writer, a device may have no end, and neither listens to
// Ctrl-C. The test `architecture_arrows` finds who opens one otherwise.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

namespace pivnp {

/// Throws InputError "LABEL: no such file", "LABEL: is a folder, expected a file" or "LABEL: not a file" (a pipe, a device).
/// Links are followed. For those who then let a library open it by its name.
void expect_regular_file(const std::filesystem::path& file, const std::string& label);

/// Binary. Throws InputError as above, or "LABEL: cannot be read: Permission denied". `label`: left out, the file's name.
std::ifstream open_regular_file(const std::filesystem::path& file, const std::string& label);
std::ifstream open_regular_file(const std::filesystem::path& file);

/// All of it. Throws InputError.
std::string text_of_file(const std::filesystem::path& file);

}  // namespace pivnp

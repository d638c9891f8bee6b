// Files that either are there in full or not at all. Private to this folder's sources.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace pivnp::io {

/// A file's descriptor, closed on leaving; below 0: none.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

/// What the operating system said of the first write to a file that failed (errno; 0: none did).
struct WriteStatus {
  int error = 0;
};

/// "PATH: cannot be written: No space left on device".
std::string write_failure(const std::filesystem::path& path, int error);

/// fsyncs the entries of a directory. Throws RunError.
void sync_directory(const std::filesystem::path& directory);

/// Renames and fsyncs the directory. Throws RunError.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Writes a text file by way of PATH.tmp, fsynced and renamed. Throws RunError.
void write_text_file(const std::filesystem::path& path, const std::string& text);

}  // namespace pivnp::io

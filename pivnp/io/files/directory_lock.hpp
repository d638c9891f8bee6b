// One run a folder.
#pragma once

#include <filesystem>

namespace pivnp::io {

/// Holds DIRECTORY/.lock while it lives: everything a run writes below that folder is its own. The lock dies with its
/// process, so a file left behind is no obstacle.
class DirectoryLock {
 public:
  /// Makes the directory where it is missing. Throws InputError naming it if it cannot be made, or if another process
  /// (or another lock of this one) holds it.
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace pivnp::io

#include "pivnp/io/files/directory_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "pivnp/core/error.hpp"
#include "pivnp/io/files/files.hpp"

namespace pivnp::io {

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  if (!std::filesystem::is_directory(directory))
    throw InputError(directory.string() + ": cannot be made: " +
                     (failed ? failed.message() : "a file of that name is there") +
                     "; expected a directory to write to");
  const std::filesystem::path file = directory / ".lock";
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) throw RunError(write_failure(file, errno));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(descriptor_);
  if (error == EWOULDBLOCK)
    throw InputError(directory.string() + ": another run is writing here (it holds .lock); expected a free directory");
  throw RunError(file.string() + ": cannot be locked: " + std::strerror(error));
}

DirectoryLock::~DirectoryLock() { ::close(descriptor_); }

}  // namespace pivnp::io

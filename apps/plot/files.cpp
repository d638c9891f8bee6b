#include "apps/plot/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "pivnp/core/error.hpp"

namespace pivnp::plot {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    throw RunError("cannot make the folder " + folder.string() + ": " +
                   (error ? error.message() : std::string("something else has its name")));
}

void write_file(const std::filesystem::path& file, std::string_view bytes) {
  const std::string temporary = file.string() + ".tmp" + std::to_string(::getpid());
  auto fail = [&](int cause) {
    ::unlink(temporary.c_str());
    throw RunError("cannot write " + file.string() + ": " + std::strerror(cause));
  };
  const int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (fd < 0) fail(errno);
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      const int cause = errno;
      ::close(fd);
      fail(cause);
    }
    bytes.remove_prefix(std::size_t(written));
  }
  if (::fsync(fd) != 0 && errno != EINVAL) {  // EINVAL: not a file that can be synced, a pipe for example
    const int cause = errno;
    ::close(fd);
    fail(cause);
  }
  if (::close(fd) != 0) fail(errno);
  if (std::rename(temporary.c_str(), file.c_str()) != 0) fail(errno);
}

}  // namespace pivnp::plot

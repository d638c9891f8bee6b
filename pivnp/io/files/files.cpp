#include "pivnp/io/files/files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "pivnp/core/error.hpp"

namespace pivnp::io {

namespace {

void write_all(int descriptor, const std::string& text, const std::filesystem::path& path) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw RunError(write_failure(path, errno));
    done += static_cast<std::size_t>(written);
  }
  if (::fsync(descriptor) != 0) throw RunError(write_failure(path, errno));
}

}  // namespace

std::string write_failure(const std::filesystem::path& path, int error) {
  return path.string() + ": cannot be written: " + std::strerror(error);
}

void sync_directory(const std::filesystem::path& directory) {
  const Descriptor d{::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  // Some file systems know no fsync of a directory (EINVAL): nothing more can be done there.
  if (d.value < 0 || (::fsync(d.value) != 0 && errno != EINVAL)) throw RunError(write_failure(directory, errno));
}

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) throw RunError(write_failure(to, errno));
  sync_directory(to.has_parent_path() ? to.parent_path() : ".");
}

void write_text_file(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path temporary = path.string() + ".tmp";
  try {
    const Descriptor d{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666)};
    if (d.value < 0) throw RunError(write_failure(temporary, errno));
    write_all(d.value, text, temporary);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  rename_file(temporary, path);
}

}  // namespace pivnp::io

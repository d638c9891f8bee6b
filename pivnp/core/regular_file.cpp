#include "pivnp/core/regular_file.hpp"

#include <cerrno>
#include <cstring>
#include <iterator>

#include "pivnp/core/error.hpp"

namespace pivnp {

namespace fs = std::filesystem;

void expect_regular_file(const fs::path& file, const std::string& label) {
  std::error_code failed;
  const fs::file_status status = fs::status(file, failed);
  if (status.type() == fs::file_type::not_found) throw InputError(label + ": no such file");
  if (failed) throw InputError(label + ": cannot be read: " + failed.message());
  if (fs::is_directory(status)) throw InputError(label + ": is a folder, expected a file");
  if (!fs::is_regular_file(status)) throw InputError(label + ": not a file");
}

std::ifstream open_regular_file(const fs::path& file, const std::string& label) {
  expect_regular_file(file, label);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (in) return in;
  const int cause = errno;
  const std::string words = label + ": cannot be read" + (cause ? std::string(": ") + std::strerror(cause) : "");
  // What the process is short of is no fault of the file.
  if (cause == EMFILE || cause == ENFILE || cause == ENOMEM) throw RunError(words);
  throw InputError(words);
}

std::ifstream open_regular_file(const fs::path& file) { return open_regular_file(file, file.string()); }

std::string text_of_file(const fs::path& file) {
  std::ifstream in = open_regular_file(file);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw InputError(file.string() + ": cannot be read");
  return text;
}

}  // namespace pivnp

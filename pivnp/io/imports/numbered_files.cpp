#include "pivnp/io/imports/numbered_files.hpp"

#include <algorithm>
#include <cctype>
#include <fnmatch.h>
#include <string>

#include "pivnp/core/error.hpp"

namespace pivnp::io {

namespace fs = std::filesystem;

namespace {

// "particles-0_2-0100.h5" -> 100: the last run of digits of the name without its ending; -1 if there is none.
std::int64_t step_number(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t last = stem.find_last_of("0123456789");
  if (last == std::string::npos) return -1;
  std::size_t first = last;
  while (first > 0 && std::isdigit(static_cast<unsigned char>(stem[first - 1]))) --first;
  if (last - first > 15) return -1;
  return std::stoll(stem.substr(first, last - first + 1));
}

}  // namespace

std::map<std::int64_t, std::vector<fs::path>> numbered_files(const std::string& pattern) {
  std::map<std::int64_t, std::vector<fs::path>> files;
  const fs::path path = pattern;
  std::error_code failed;
  if (fs::is_regular_file(path, failed)) return {{std::max<std::int64_t>(0, step_number(path)), {path}}};
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (fs::is_directory(folder, failed))
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (fnmatch(path.filename().c_str(), entry.path().filename().c_str(), 0) != 0) continue;
      if (!entry.is_regular_file(failed)) throw InputError(entry.path().string() + ": not a file");
      const std::int64_t number = step_number(entry.path());
      if (number < 0) throw InputError(entry.path().string() + ": no number in the name, expected the step's");
      files[number].push_back(entry.path());
    }
  if (files.empty()) throw InputError(pattern + ": no such file, and no file matches it as a pattern");
  for (auto& [number, list] : files) std::sort(list.begin(), list.end());
  return files;
}

}  // namespace pivnp::io

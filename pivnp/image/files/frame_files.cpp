#include "pivnp/image/files/frame_files.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "pivnp/core/error.hpp"
#include "pivnp/image/files/frame_order.hpp"

namespace pivnp::image {

namespace fs = std::filesystem;

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// The run of digits at `at`, without its leading zeros; `at` moves behind it.
std::string_view digits(std::string_view s, std::size_t& at) {
  std::size_t begin = at;
  while (at < s.size() && is_digit(s[at])) ++at;
  while (begin + 1 < at && s[begin] == '0') ++begin;
  return s.substr(begin, at - begin);
}

FrameFiles in_order(std::vector<fs::path> paths) {
  TimeOrder order = in_time_order(std::move(paths));
  FrameFiles out{{}, std::move(order.clock), std::move(order.remarks)};
  for (fs::path& p : order.files) out.files.push_back({std::int64_t(out.files.size()), std::move(p)});
  return out;
}

std::string in_small_letters(std::string text) {
  for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool has_image_ending(const fs::path& file) {
  constexpr std::array<std::string_view, 12> known = {".png", ".tif", ".tiff", ".bmp", ".jpg",  ".jpeg",
                                                      ".jpe", ".pgm", ".ppm",  ".pnm", ".webp", ".jp2"};
  const std::string ending = in_small_letters(file.extension().string());
  return std::find(known.begin(), known.end(), ending) != known.end();
}

std::vector<fs::path> entries_of(const fs::path& folder, const std::string& what) {
  std::error_code error;
  std::vector<fs::path> out;
  fs::directory_iterator it(folder, error);
  if (error) throw InputError(what + ": folder '" + folder.string() + "' cannot be read: " + error.message());
  for (const fs::directory_iterator end; it != end; it.increment(error)) {
    if (error) throw InputError(what + ": folder '" + folder.string() + "' cannot be read: " + error.message());
    out.push_back(it->path());
  }
  return out;
}

// What a folder holds, for a message about what was not found in it.
std::string holdings(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return "; there is no folder '" + folder.string() + "'";
  std::vector<std::string> names;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    names.push_back(it->path().filename().string());
  if (error) return "; folder '" + folder.string() + "' cannot be read: " + error.message();
  if (names.empty()) return "; folder '" + folder.string() + "' is empty";
  const auto first = std::min_element(names.begin(), names.end(), natural_less);
  return "; folder '" + folder.string() + "' holds " + std::to_string(names.size()) +
         (names.size() == 1 ? " entry: '" : " entries, the first is '") + *first + "'";
}

bool has_wildcard(const std::string& part) { return part.find_first_of("*?[") != std::string::npos; }

std::string brackets_escaped(const std::string& part) {
  std::string out;
  for (const char c : part) {
    if (c == '[' || c == ']') out += '\\';
    out += c;
  }
  return out;
}

std::vector<fs::path> matches(const fs::path& folder, const std::string& part, const std::string& what) {
  std::vector<fs::path> out;
  std::error_code error;
  if (!fs::is_directory(folder, error)) return out;
  const fs::path given(part);
  const bool image = has_image_ending(given);
  for (const fs::path& entry : entries_of(folder, what)) {
    const fs::path ending = entry.extension();
    const bool alike = image && in_small_letters(ending.string()) == in_small_letters(given.extension().string());
    const std::string pattern = alike ? given.stem().string() + ending.string() : part;
    if (fnmatch(pattern.c_str(), entry.filename().c_str(), FNM_PERIOD) == 0) out.push_back(entry);
  }
  return out;
}

// One part of a glob under every folder reached so far. A part that exists under its very name wins.
std::vector<fs::path> expanded(const std::vector<fs::path>& folders, const std::string& part, const std::string& what) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / part, error)) {
      out.push_back(folder / part);
    } else if (has_wildcard(part)) {
      std::vector<fs::path> found = matches(folder, part, what);
      if (found.empty()) found = matches(folder, brackets_escaped(part), what);
      out.insert(out.end(), found.begin(), found.end());
    }
  }
  return out;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = digits(a, i), y = digits(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a.size() != b.size() ? a.size() < b.size() : a < b;  // only leading zeros differ
}

const fs::path* FrameFiles::find(std::int64_t index) const {
  const std::int64_t number = files.front().number + index;
  const auto it = std::lower_bound(files.begin(), files.end(), number,
                                   [](const File& f, std::int64_t n) { return f.number < n; });
  return it != files.end() && it->number == number ? &it->path : nullptr;
}

std::optional<NumberedName> NumberedName::parse(const std::string& name, const std::string& what) {
  NumberedName out;
  bool found = false;
  for (std::size_t at = 0; at < name.size(); ++at) {
    std::string& side = found ? out.after_ : out.before_;
    std::size_t end = at + 1;
    while (name[at] == '%' && end < name.size() && is_digit(name[end])) ++end;
    if (name[at] == '%' && end < name.size() && name[end] == 'd') {
      if (found) throw InputError(what + ": '" + name + "' has more than one %d; a printf pattern takes one");
      const std::string width = name.substr(at + 1, end - at - 1);
      if (width.size() > 3) throw InputError(what + ": '" + name + "' asks for an impossible number width");
      found = true;
      out.pad_ = width.starts_with('0') ? '0' : ' ';
      out.width_ = width.empty() ? 0 : std::size_t(std::stoi(width));
      at = end;
    } else {
      side += name[at];
      if (name.compare(at, 2, "%%") == 0) ++at;
    }
  }
  return found ? std::optional(out) : std::nullopt;
}

std::string NumberedName::name(std::int64_t number, std::size_t sign) const {
  const std::string plain = std::to_string(number < 0 ? -number : number), minus = number < 0 ? "-" : "";
  const std::size_t length = plain.size() + (sign > 0 ? 0 : minus.size()), padding = length < width_ ? width_ - length : 0;
  const std::string pad(padding, pad_);
  return before_ + (pad_ == '0' ? minus + pad : pad + minus) + plain + after_;
}

std::optional<std::int64_t> NumberedName::number(const std::string& file_name) const {
  if (file_name.size() <= before_.size() + after_.size() || !file_name.starts_with(before_) ||
      !file_name.ends_with(after_))
    return std::nullopt;
  std::string middle = file_name.substr(before_.size(), file_name.size() - before_.size() - after_.size());
  middle.erase(0, middle.find_first_not_of(' '));
  const bool minus = middle.starts_with('-');
  if (minus) middle.erase(0, 1);
  if (middle.empty() || middle.size() > 18 || !std::all_of(middle.begin(), middle.end(), is_digit)) return std::nullopt;
  const std::int64_t value = (minus ? -1 : 1) * std::stoll(middle);
  return name(value) == file_name || (minus && name(value, 1) == file_name) ? std::optional(value) : std::nullopt;
}

FrameFiles files_in_folder(const fs::path& folder, const std::string& what) {
  std::vector<fs::path> images;
  for (const fs::path& entry : entries_of(folder, what)) {
    std::error_code error;
    const bool hidden = entry.filename().native().starts_with('.');
    if (!hidden && has_image_ending(entry) && !fs::is_directory(entry, error)) images.push_back(entry);
  }
  if (images.empty())
    throw InputError(what + ": no image (png, tif, bmp, jpg, pgm ...) in '" + folder.string() + "'" + holdings(folder));
  return in_order(std::move(images));
}

FrameFiles files_of_pattern(const fs::path& folder, const NumberedName& name, const std::string& what) {
  FrameFiles out;
  std::error_code error;
  if (fs::is_directory(folder, error))
    for (const fs::path& entry : entries_of(folder, what))
      if (const auto number = name.number(entry.filename().string())) out.files.push_back({*number, entry});
  if (out.files.empty())
    throw InputError(what + ": no file is named like '" + (folder / name.name(0)).string() + "'" + holdings(folder));
  std::sort(out.files.begin(), out.files.end(),
            [](const FrameFiles::File& a, const FrameFiles::File& b) { return a.number < b.number; });
  return out;
}

FrameFiles files_of_glob(const fs::path& base, const std::string& pattern, const std::string& what) {
  const fs::path given(pattern);
  std::vector<fs::path> found{given.is_absolute() ? given.root_path() : base};
  fs::path deepest = found.front();  // as far as there was anything, for the message
  for (const fs::path& part : given.relative_path()) {
    if (part.empty()) continue;  // a slash at the end
    found = expanded(found, part.string(), what);
    if (found.empty()) break;
    std::error_code error;
    if (fs::is_directory(found.front(), error)) deepest = found.front();
  }
  std::erase_if(found, [](const fs::path& p) {
    std::error_code error;
    return fs::is_directory(p, error);
  });
  if (found.empty()) throw InputError(what + ": nothing matches '" + (base / given).string() + "'" + holdings(deepest));
  const fs::path ending = given.extension();
  const auto others = std::count_if(found.begin(), found.end(), [&](const fs::path& p) {
    return p.extension() != ending && in_small_letters(p.extension().string()) == in_small_letters(ending.string());
  });
  FrameFiles out = in_order(std::move(found));
  if (others > 0)
    out.remarks.push_back({std::to_string(others) + " of " + std::to_string(out.files.size()) + " names end in other letters than " +
                          given.filename().string() + " (small for capital ones); they were taken too."});
  return out;
}

}  // namespace pivnp::image

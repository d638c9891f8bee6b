#include "pivnp/io/imports/text_table.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/read_number.hpp"

namespace pivnp::io {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view around = " \t\"\r";
  const std::size_t first = text.find_first_not_of(around);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(around) - first + 1);
}

}  // namespace

TextLines::TextLines(std::filesystem::path file) : file_(std::move(file)), text_(text_of_file(file_)), rest_(text_) {
  if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
}

bool TextLines::next(std::string_view& line) {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(rest_.size(), end + 1));
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++number_;
  return true;
}

std::string TextLines::at(int line) const { return file_.string() + ":" + std::to_string(line) + ": "; }

std::optional<double> read_number(std::string_view text) {
  std::string digits(text.starts_with('+') ? text.substr(1) : text);  // from_chars takes no plus
  // Fortran drops the E of a three-digit exponent (1.0-100) and may write D.
  for (std::size_t k = 1; k < digits.size(); ++k) {
    const auto before = static_cast<unsigned char>(digits[k - 1]);
    if ((digits[k] == 'D' || digits[k] == 'd') && (std::isdigit(before) || before == '.')) digits[k] = 'E';
    if ((digits[k] == '-' || digits[k] == '+') && (std::isdigit(before) || before == '.') && digits.size() == k + 4) digits.insert(k++, "E");
  }
  std::erase(digits, '+');
  double v = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), v);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error != std::errc::result_out_of_range) return v;
  long double wide = 0;
  const bool still = std::from_chars(digits.data(), digits.data() + digits.size(), wide).ec == std::errc::result_out_of_range;
  const bool small = still ? digits.find("E-") != digits.npos || digits.find("e-") != digits.npos : std::abs(wide) < 1;
  if (small) return 0;
  return digits.starts_with('-') ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
}

double TextLines::value(std::string_view cell, std::string_view column) const {
  if (cell.empty() || column_name(cell) == "nan") return std::nan("");
  const std::optional<double> v = read_number(cell);
  const std::string found = at() + "column '" + shown(column) + "': found '" + shown(cell) + "', expected ";
  if (!v) throw InputError(found + "a number");
  if (std::isnan(*v)) return *v;  // "-nan", as some programs write it
  if (!(std::abs(*v) <= double(std::numeric_limits<float>::max())))
    throw InputError(found + "a finite number (of single precision), or nan where nothing is known");
  return *v;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator == ' ') {
    constexpr std::string_view blanks = " \t";
    for (std::size_t begin = line.find_first_not_of(blanks); begin != line.npos;) {
      const std::size_t end = std::min(line.find_first_of(blanks, begin), line.size());
      cells.push_back(trimmed(line.substr(begin, end - begin)));
      begin = line.find_first_not_of(blanks, end);
    }
    return cells;
  }
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    cells.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return cells;
}

char separator_of(std::string_view line) {
  for (const char separator : {';', '\t', ','})
    if (line.find(separator) != line.npos) return separator;
  return ' ';
}

std::string column_name(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ' && c != '"') out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string_view line_of_names(TextLines& lines) {
  std::string_view line;
  do {
    if (!lines.next(line)) throw InputError(lines.file().string() + ": is empty, expected a line of column names");
  } while (line.empty() || line.starts_with('#'));
  return line;
}

std::vector<std::string> header_of(std::string_view line, char separator) {
  std::vector<std::string> names;
  for (const std::string_view cell : cells_of(line, separator)) names.push_back(column_name(cell));
  return names;
}

std::vector<std::string_view> row_of(const TextLines& lines, std::string_view line, char separator, std::size_t columns) {
  std::vector<std::string_view> cells = cells_of(line, separator);
  if (cells.size() != columns)
    throw InputError(lines.at() + "found " + std::to_string(cells.size()) + " values, expected " + std::to_string(columns));
  return cells;
}

int column_of(const std::vector<std::string>& header, const std::vector<const char*>& names) {
  for (const char* name : names)
    for (std::size_t k = 0; k < header.size(); ++k)
      if (header[k] == name) return int(k);
  return -1;
}

}  // namespace pivnp::io

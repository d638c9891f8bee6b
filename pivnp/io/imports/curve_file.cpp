#include "pivnp/io/imports/curve_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "pivnp/core/error.hpp"
#include "pivnp/core/printable.hpp"
#include "pivnp/core/regular_file.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/read_number.hpp"

namespace pivnp::io {

namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\""), last = text.find_last_not_of(" \t\r\"");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells;
  if (separator != ' ') {
    bool quoted = false;  // names between quotation marks may hold the separator, as those of a report's tables do
    std::string cell;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c != separator || quoted) {
        cell += c;
        continue;
      }
      cells.push_back(trimmed(cell));
      cell.clear();
    }
    if (!cell.empty()) cells.push_back(trimmed(cell));
    return cells;
  }
  const std::string text = trimmed(line);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find("  ", begin), text.size());
    cells.push_back(trimmed(text.substr(begin, end - begin)));
    begin = std::min(text.find_first_not_of(' ', end), text.size());
  }
  return cells;
}

std::string unit_in_head(const std::string& name, const std::string& otherwise) {
  const std::size_t open = name.find('('), close = name.find(')', open);
  return open == std::string::npos || close == std::string::npos ? otherwise : name.substr(open + 1, close - open - 1);
}

}  // namespace

Curve read_curve(const std::filesystem::path& file, const std::string& column, double step) {
  std::istringstream in(text_of_file(file));
  std::string line;
  int number = 0;
  const auto next = [&] {
    while (std::getline(in, line)) {
      ++number;
      if (!trimmed(line).empty() && line[0] != '#') return true;
    }
    return false;
  };
  const auto at = [&] { return file.string() + ":" + std::to_string(number) + ": "; };
  if (!next()) throw InputError(file.string() + ": is empty, expected a line of column names");
  const char separator = line.find(',') != line.npos   ? ','
                         : line.find(';') != line.npos  ? ';'
                         : line.find('\t') != line.npos ? '\t'
                                                        : ' ';
  const std::vector<std::string> names = cells_of(line, separator);
  std::size_t place = 1;
  if (!column.empty())
    place = std::size_t(std::find(names.begin(), names.end(), column) - names.begin());
  if (place >= names.size())
    throw InputError(at() + (column.empty() ? "found one column, expected times and values"
                                            : "no column '" + column + "'" + did_you_mean(column, names)));
  std::string first = names[0];
  for (char& c : first) c = char(std::tolower(static_cast<unsigned char>(c)));
  const bool counted = first == "frame" || first == "step";

  Curve curve;
  curve.value_name = printable(names[place]);
  curve.value_unit = unit_in_head(curve.value_name, "1");
  curve.time_unit = counted ? "s" : unit_in_head(printable(names[0]), "1");
  while (next()) {
    const std::vector<std::string> cells = cells_of(line, separator);
    const auto value = [&](std::size_t k) {
      if (k >= cells.size() || cells[k].empty() || cells[k] == "nan" || cells[k] == "NaN") return std::nan("");
      const std::optional<double> v = read_number(cells[k]);
      if (!v)
        throw InputError(at() + "column '" + shown(names[k]) + "': found '" + shown(cells[k]) + "', expected a number");
      if (std::isnan(*v)) return *v;  // "-nan", "NAN", as some programs write it
      if (!std::isfinite(*v))
        throw InputError(at() + "column '" + shown(names[k]) + "': found '" + shown(cells[k]) +
                         "', expected a finite number, or nan");
      return *v;
    };
    const double time = value(0) * (counted ? step : 1);
    if (!std::isfinite(time) || (!curve.time.empty() && !(time > curve.time.back())))
      throw InputError(at() + "times must ascend");
    curve.time.push_back(time);
    curve.value.push_back(value(place));
  }
  if (curve.time.empty()) throw InputError(file.string() + ": no row of values");
  return curve;
}

}  // namespace pivnp::io

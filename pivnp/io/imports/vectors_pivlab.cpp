// PIVlab's text files, one a pair (its +export/file_save.m): up to two lines about the file ("PIVlab ..., ASCII chart
// output - DATE"; "FRAME: 1, filenames: A & B, conversion factor xy (px -> m): a, conversion factor uv (px/frame ->
// m/s): b"), one line of names with units, "x [px]" or "x [m]", "u [px/frame]", "u [m/frame]" or "u [m/s]", then rows
// separated by commas, tabs or blanks. In pixels the image's first pixel is (1, 1), as everywhere in MATLAB. y points
// downward unless the program's calibration turned it over, which the file does not say. "Vector type" is 0 for masked,
// 1 for measured, 2 for refused by the validation (NaN, or interpolated), 3 for measured at the second peak. The column
// "uncertainty" is left alone: it is no standard uncertainty of u and v.
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

struct Column {
  std::string name, unit;
};

// "x [px],y [px],shear rate (...) [1/frame]": names before units in brackets, whatever separates them.
std::vector<Column> columns_of(std::string_view line) {
  std::vector<Column> columns;
  while (true) {
    const std::size_t open = line.find('['), close = line.find(']');
    if (open == line.npos || close == line.npos || close < open) return columns;
    std::string_view name = line.substr(0, open);
    while (!name.empty() && std::string_view(",\t ").find(name.front()) != name.npos) name.remove_prefix(1);
    columns.push_back({column_name(name), column_name(line.substr(open + 1, close - open - 1))});
    line.remove_prefix(close + 1);
  }
}

// The number behind `label`; NaN if there is none.
double factor(std::string_view line, std::string_view label) {
  const std::size_t at = line.find(label);
  double value = std::numeric_limits<double>::quiet_NaN();
  if (at == line.npos) return value;
  line.remove_prefix(at + label.size());
  while (line.starts_with(' ')) line.remove_prefix(1);
  std::from_chars(line.data(), line.data() + line.size(), value);
  return value;
}

std::string image_name(std::string_view text) {
  for (const std::string_view label : {"A: ", "B: "})
    if (text.starts_with(label)) text.remove_prefix(label.size());
  return printable_part(text, 200);
}

void name_images(std::string_view line, ImportedVectors& out) {
  constexpr std::string_view before = "filenames: ", after = ", conversion factor", between = " & ";
  const std::size_t begin = line.find(before), end = line.find(after);
  if (begin == line.npos || end == line.npos || end < begin + before.size()) return;
  const std::string_view both = line.substr(begin + before.size(), end - begin - before.size());
  const std::size_t at = both.find(between);
  if (at == both.npos) return;
  out.first = image_name(both.substr(0, at));
  out.second = image_name(both.substr(at + between.size()));
}

VectorStatus status_of(const TextLines& lines, double type, bool known) {
  if (type == 0) return VectorStatus::masked;
  if (type == 1 || type == 3) return known ? VectorStatus::valid : VectorStatus::failed;
  if (type == 2) return known ? VectorStatus::replaced : VectorStatus::failed;
  throw InputError(lines.at() + "column 'Vector type': found " + number(type) + ", expected 0, 1, 2 or 3");
}

}  // namespace

ImportedVectors read_pivlab(const std::filesystem::path& file, std::optional<double> step) {
  TextLines lines(file);
  ImportedVectors out;
  std::string_view line;
  double stated = std::numeric_limits<double>::quiet_NaN();  // time between the frames, s
  std::vector<Column> columns;
  while (columns.empty()) {
    if (!lines.next(line))
      throw InputError(file.string() + ": no line of column names, expected 'x [px],y [px],u [px/frame],v [px/frame]' or the like");
    if (line.empty() || line.starts_with("PIVlab")) continue;
    if (line.starts_with("FRAME:")) {
      stated = factor(line, "conversion factor xy (px -> m):") / std::abs(factor(line, "conversion factor uv (px/frame -> m/s):"));
      name_images(line, out);
      continue;
    }
    columns = columns_of(line);
    if (columns.empty() || columns[0].name != "x")
      throw InputError(lines.at() + "found '" + shown(line) +
                       "', expected the line of column names, 'x [px],y [px],u [px/frame],v [px/frame]' or the like");
  }
  const auto named = [&](const char* name) {
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns[k].name == name) return int(k);
    return -1;
  };
  const auto needed = [&](const char* name) {
    const int at = named(name);
    if (at < 0) throw InputError(lines.at() + "no column '" + name + "' among the names, expected x, y, u and v");
    return std::size_t(at);
  };
  const std::size_t x = needed("x"), y = needed("y"), u = needed("u"), v = needed("v");
  const int type = named("vectortype");
  out.pixels = columns[x].unit == "px";
  const std::string unit = columns[u].unit, length = out.pixels ? "px" : "m";
  double scale = 1;
  if (!out.pixels && unit == "m/s") {
    const double dt = step.value_or(stated);
    if (!(dt > 0) || !std::isfinite(dt))
      throw InputError(lines.at() + "u is a velocity (m/s), but neither the file's second line nor a rate (rate_hz) says "
                                    "the time between the frames");
    if (step && std::abs(stated - *step) > 0.01 * *step)
      throw InputError(lines.at() + "found a time between the frames of " + number(stated) +
                       " s by the file's conversion factors, expected " + number(*step) + " s by the rate (rate_hz)");
    scale = dt;
  } else if (columns[x].unit != length || columns[y].unit != length || columns[v].unit != unit ||
             unit != length + "/frame") {
    throw InputError(lines.at() + "found units '" + shown(columns[x].unit) + "', '" + shown(columns[y].unit) + "', '" +
                     shown(unit) + "' and '" + shown(columns[v].unit) +
                     "' of x, y, u and v, expected px and px/frame, m and m/frame, or m and m/s");
  }
  const double first_pixel = out.pixels ? 1 : 0;
  char separator = ' ';
  for (bool first = true; lines.next(line);) {
    if (line.empty()) continue;
    if (first) separator = separator_of(line);
    first = false;
    const std::vector<std::string_view> cells = cells_of(line, separator);
    if (cells.size() != columns.size())
      throw InputError(lines.at() + "found " + std::to_string(cells.size()) + " values, expected " +
                       std::to_string(columns.size()));
    const auto value = [&](std::size_t k) { return lines.value(cells[k], columns[k].name); };
    out.line.push_back(lines.number());
    out.x.push_back({value(x) - first_pixel, value(y) - first_pixel});
    out.d.push_back({value(u) * scale, value(v) * scale});
    if (type >= 0)
      out.status.push_back(status_of(lines, value(std::size_t(type)), std::isfinite(out.d.back()[0] + out.d.back()[1])));
  }
  return out;
}

}  // namespace pivnp::io

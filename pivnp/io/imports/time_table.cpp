#include "pivnp/io/imports/time_table.hpp"

#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

struct UnitRow {
  std::string_view quantity, unit;
  double times, by;
};
constexpr UnitRow unit_rows[] = {
    {"time", "s", 1, 1},           {"time", "ms", 1, 1e3},         {"time", "min", 60, 1},         {"time", "h", 3600, 1},
    {"displacement", "m", 1, 1},   {"displacement", "mm", 1, 1e3}, {"displacement", "cm", 1, 1e2}, {"velocity", "m_s", 1, 1},
    {"velocity", "mm_s", 1, 1e3},  {"velocity", "mm_min", 1, 6e4}, {"angle", "rad", 1, 1},         {"angle", "deg", M_PI, 180},
    {"angular_velocity", "rad_s", 1, 1}, {"angular_velocity", "deg_s", M_PI, 180},
    {"force", "n_m", 1, 1},        {"force", "kn_m", 1e3, 1}};

// "displacement_x" of "displacement_x_mm"; `wanted` holds "displacement_x".
std::optional<UnitRow> unit_of(const std::string& column, const std::string& quantity) {
  const std::string plain = quantity.ends_with("_x") || quantity.ends_with("_y") ? quantity.substr(0, quantity.size() - 2) : quantity;
  if (!column.starts_with(quantity + "_")) return std::nullopt;
  for (const UnitRow& row : unit_rows)
    if (row.quantity == plain && column.substr(quantity.size() + 1) == row.unit) return row;
  return std::nullopt;
}

std::string expected_columns(const std::vector<std::string>& wanted) {
  std::string text = "time_s and one or more of ";
  for (std::size_t k = 0; k < wanted.size(); ++k) text += (k ? ", " : "") + wanted[k];
  return text + " with their unit (displacement_x_mm)";
}

}  // namespace

const std::vector<double>* TimeTable::find(const std::string& quantity) const {
  const auto at = columns.find(quantity);
  return at == columns.end() ? nullptr : &at->second;
}

TimeTable read_time_table(const std::filesystem::path& file, const std::vector<std::string>& wanted) {
  TextLines lines(file);
  std::string_view line = line_of_names(lines);
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  TimeTable out;
  std::vector<std::pair<std::string, UnitRow>> of;
  for (const std::string& name : header) {
    std::optional<std::pair<std::string, UnitRow>> found;
    if (const auto unit = unit_of(name, "time")) found.emplace("time", *unit);
    for (const std::string& quantity : wanted)
      if (const auto unit = unit_of(name, quantity)) found.emplace(quantity, *unit);
    if (!found) throw InputError(lines.at() + "found a column '" + name + "', expected " + expected_columns(wanted));
    for (const auto& [before, unit] : of)
      if (before == found->first) throw InputError(lines.at() + "found " + before + " twice, expected it once");
    of.push_back(*found);
  }
  bool timed = false;
  for (const auto& [quantity, unit] : of) timed |= quantity == "time";
  if (!timed || of.size() < 2) throw InputError(lines.at() + (timed ? "found time alone" : "found no time") + ", expected " + expected_columns(wanted));
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = row_of(lines, line, separator, header.size());
    for (std::size_t k = 0; k < of.size(); ++k) {
      const double value = lines.value(cells[k], header[k]);
      if (std::isnan(value)) throw InputError(lines.at() + "column '" + header[k] + "': found none, expected a number");
      const double si = value * of[k].second.times / of[k].second.by;
      (of[k].first == "time" ? out.time : out.columns[of[k].first]).push_back(si);
    }
    if (out.time.size() > 1 && !(out.time.back() > out.time[out.time.size() - 2]))
      throw InputError(lines.at() + "found " + number(out.time.back()) + " s after " + number(out.time[out.time.size() - 2]) + " s, expected times that ascend");
  }
  if (out.time.size() < 2)
    throw InputError(file.string() + ": found " + std::to_string(out.time.size()) + " rows, expected two or more");
  return out;
}

}  // namespace pivnp::io

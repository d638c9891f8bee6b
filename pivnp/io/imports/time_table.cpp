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
    {"force", "n_m", 1, 1},        {"force", "kn_m", 1e3, 1},      {"strain", "1", 1, 1},         {"strain", "percent", 1, 100},
    {"stress", "pa", 1, 1},        {"stress", "kpa", 1e3, 1},      {"stress", "mpa", 1e6, 1}};

// "displacement_x" of "displacement_x_mm"; `wanted` holds "displacement_x". Of a strain or a stress the last word counts.
std::string plain_name(const std::string& quantity) {
  for (const std::string plain : {"strain", "stress"})
    if (quantity.ends_with("_" + plain)) return plain;
  if (quantity == "pore_pressure") return "stress";
  return quantity.ends_with("_x") || quantity.ends_with("_y") ? quantity.substr(0, quantity.size() - 2) : quantity;
}

std::optional<UnitRow> unit_of(const std::string& column, const std::string& quantity) {
  const std::string plain = plain_name(quantity);
  if (!column.starts_with(quantity + "_")) return std::nullopt;
  for (const UnitRow& row : unit_rows)
    if (row.quantity == plain && column.substr(quantity.size() + 1) == row.unit) return row;
  return std::nullopt;
}

std::string listed(const std::vector<std::string>& wanted) {
  std::string text;
  for (std::size_t k = 0; k < wanted.size(); ++k) text += (k ? ", " : "") + wanted[k];
  return text;
}

using QuantityColumns = std::map<std::string, std::vector<double>>;

// All columns of a table in SI, by their quantities; `each_row` sees the columns after each row. Throws InputError.
template <class EachRow>
QuantityColumns read_quantities(TextLines& lines, const std::vector<std::string>& wanted, const std::string& expected, EachRow&& each_row) {
  std::string_view line = line_of_names(lines);
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  QuantityColumns out;
  std::vector<std::pair<std::string, UnitRow>> of;
  for (const std::string& name : header) {
    std::optional<std::pair<std::string, UnitRow>> found;
    for (const std::string& quantity : wanted)
      if (const auto unit = unit_of(name, quantity)) found.emplace(quantity, *unit);
    if (!found) throw InputError(lines.at() + "found a column '" + name + "', expected " + expected);
    if (!out.emplace(found->first, std::vector<double>{}).second)
      throw InputError(lines.at() + "found " + found->first + " twice, expected it once");
    of.push_back(*found);
  }
  each_row(out);
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = row_of(lines, line, separator, header.size());
    for (std::size_t k = 0; k < of.size(); ++k) {
      const double value = lines.value(cells[k], header[k]);
      if (std::isnan(value)) throw InputError(lines.at() + "column '" + header[k] + "': found none, expected a number");
      out[of[k].first].push_back(value * of[k].second.times / of[k].second.by);
    }
    each_row(out);
  }
  const std::size_t rows = out.begin()->second.size();
  if (rows < 2) throw InputError(lines.file().string() + ": found " + std::to_string(rows) + " rows, expected two or more");
  return out;
}

}  // namespace

const std::vector<double>* TimeTable::find(const std::string& quantity) const {
  const auto at = columns.find(quantity);
  return at == columns.end() ? nullptr : &at->second;
}

TimeTable read_time_table(const std::filesystem::path& file, const std::vector<std::string>& wanted) {
  TextLines lines(file);
  const std::string expected = "time_s and one or more of " + listed(wanted) + " with their unit (displacement_x_mm)";
  std::vector<std::string> all = wanted;
  all.insert(all.begin(), "time");
  TimeTable out;
  out.columns = read_quantities(lines, all, expected, [&](const QuantityColumns& columns) {
    const auto time = columns.find("time");
    if (time == columns.end() || columns.size() < 2)
      throw InputError(lines.at() + (time != columns.end() ? "found time alone" : "found no time") + ", expected " + expected);
    const std::vector<double>& t = time->second;
    if (t.size() > 1 && !(t.back() > t[t.size() - 2]))
      throw InputError(lines.at() + "found " + number(t.back()) + " s after " + number(t[t.size() - 2]) + " s, expected times that ascend");
  });
  out.time = std::move(out.columns.extract("time").mapped());
  return out;
}

const std::vector<std::string>& test_quantities() {
  static const std::vector<std::string> all = {"axial_strain",    "volumetric_strain", "shear_strain",     "deviator_stress",
                                               "vertical_stress", "mean_stress",       "horizontal_stress", "shear_stress", "pore_pressure"};
  return all;
}

std::map<std::string, std::vector<double>> read_test_table(const std::filesystem::path& file) {
  TextLines lines(file);
  const std::string expected = "axial_strain or shear_strain and one or more of " + listed(test_quantities()) + " with their unit (axial_strain_percent, deviator_stress_kpa)";
  return read_quantities(lines, test_quantities(), expected, [&](const QuantityColumns& columns) {
    if (columns.size() < 2) throw InputError(lines.at() + "found one column, expected " + expected);
  });
}

}  // namespace pivnp::io

#include "pivnp/io/imports/stress_file.hpp"

#include <array>
#include <cmath>
#include <string>

#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

// One row a point, of the columns that are named.
template <std::size_t N>
std::vector<std::array<double, N>> read_points(const std::filesystem::path& file,
                                               const std::array<const char*, N>& names) {
  TextLines lines(file);
  std::string_view line = line_of_names(lines);
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  std::array<int, N> column{};
  std::string all;
  for (const char* name : names) {
    if (!all.empty()) all += ", ";
    all += name;
  }
  for (std::size_t k = 0; k < N; ++k) {
    column[k] = column_of(header, {names[k]});
    if (column[k] < 0) throw InputError(lines.at() + "no column '" + names[k] + "', expected " + all);
  }
  std::vector<std::array<double, N>> out;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = row_of(lines, line, separator, header.size());
    std::array<double, N>& value = out.emplace_back();
    for (std::size_t k = 0; k < N; ++k) {
      value[k] = lines.value(cells[std::size_t(column[k])], names[k]);
      if (std::isnan(value[k])) throw InputError(lines.at() + "column '" + names[k] + "': found none, expected a number");
    }
  }
  if (out.size() < 3)
    throw InputError(file.string() + ": found " + std::to_string(out.size()) + " points, expected three or more");
  return out;
}

}  // namespace

StressValues read_stress(const std::filesystem::path& file) {
  constexpr std::array names = {"x_m", "y_m", "stress_xx_pa", "stress_yy_pa", "stress_zz_pa", "stress_xy_pa"};
  StressValues out;
  for (const auto& value : read_points(file, names)) {
    out.at.push_back({value[0], value[1]});
    out.stress.push_back({value[2], value[3], value[4], value[5]});
  }
  return out;
}

PressureValues read_pressure(const std::filesystem::path& file) {
  constexpr std::array names = {"x_m", "y_m", "pressure_pa"};
  PressureValues out;
  for (const auto& value : read_points(file, names)) {
    out.at.push_back({value[0], value[1]});
    out.pressure.push_back(value[2]);
  }
  return out;
}

}  // namespace pivnp::io

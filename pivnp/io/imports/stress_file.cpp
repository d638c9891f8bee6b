#include "pivnp/io/imports/stress_file.hpp"

#include <cmath>

#include "pivnp/core/error.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

StressValues read_stress(const std::filesystem::path& file) {
  constexpr std::array names = {"x_m", "y_m", "stress_xx_pa", "stress_yy_pa", "stress_zz_pa", "stress_xy_pa"};
  TextLines lines(file);
  std::string_view line = line_of_names(lines);
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  std::array<int, names.size()> column{};
  for (std::size_t k = 0; k < names.size(); ++k) {
    column[k] = column_of(header, {names[k]});
    if (column[k] < 0) throw InputError(lines.at() + "no column '" + names[k] + "', expected x_m, y_m, stress_xx_pa, stress_yy_pa, stress_zz_pa, stress_xy_pa");
  }
  StressValues out;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const auto cells = row_of(lines, line, separator, header.size());
    std::array<double, names.size()> value{};
    for (std::size_t k = 0; k < names.size(); ++k) {
      value[k] = lines.value(cells[std::size_t(column[k])], names[k]);
      if (std::isnan(value[k])) throw InputError(lines.at() + "column '" + names[k] + "': found none, expected a number");
    }
    out.at.push_back({value[0], value[1]});
    out.stress.push_back({value[2], value[3], value[4], value[5]});
  }
  if (out.at.size() < 3)
    throw InputError(file.string() + ": found " + std::to_string(out.at.size()) + " points, expected three or more");
  return out;
}

}  // namespace pivnp::io

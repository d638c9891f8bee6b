// Curves in text files: one quantity against time, as laboratories and digitised figures have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace pivnp::io {

struct Curve {
  std::vector<double> time, value;       // ascending times; NaN where the file has none
  std::string value_name, value_unit;    // as the column is headed; the unit in its first brackets, else "1"
  std::string time_unit;                 // likewise; "s" for a column of frames, counted by `step`
};

/// Reads the first column (times; a column called frame or step is multiplied by `step`) and the one called `column`
/// (left empty: the second). Columns are separated by commas, semicolons, tabs, or two or more blanks; the first line
/// that is no remark (#) names them. Throws InputError naming file, line and what was expected.
Curve read_curve(const std::filesystem::path& file, const std::string& column, double step);

}  // namespace pivnp::io

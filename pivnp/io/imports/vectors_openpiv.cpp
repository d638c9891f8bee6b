// OpenPIV's text files, one a pair (openpiv.tools.save): a line "# x y u v flags mask" (earlier versions "# x y u v mask"),
// then rows, all separated by tabs, commas or blanks. The program keeps rows from the top of the image to its bottom.
// Its transform_coordinates() turns the column y over within the grid and the sign of v, so that both point upward: y
// then falls from the first row to the last, else it rises. flags: 0 valid, 1 refused, 2 interpolated; mask beside flags:
// 1 masked; mask alone: 1 refused. Places and displacements are taken as pixels, and pixels from frame to frame: scale
// and time step of the program are not in its files.
#include <cmath>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

ImportedVectors read_openpiv(const std::filesystem::path& file, std::optional<double>) {
  TextLines lines(file);
  std::string_view line;
  do {
    if (!lines.next(line)) throw InputError(file.string() + ": is empty, expected '# x y u v flags mask'");
  } while (line.empty());
  if (!line.starts_with('#'))
    throw InputError(lines.at() + "found '" + shown(line) + "', expected the line of column names, '# x y u v flags mask'");
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line.substr(1), separator);
  const auto needed = [&](const char* name) {
    const int at = column_of(header, {name});
    if (at < 0) throw InputError(lines.at() + "no column '" + name + "' among the names, expected x, y, u and v");
    return std::size_t(at);
  };
  const std::size_t x = needed("x"), y = needed("y"), u = needed("u"), v = needed("v");
  const int flags = column_of(header, {"flags"}), mask = column_of(header, {"mask"});
  ImportedVectors out;
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<std::string_view> cells = row_of(lines, line, separator, header.size());
    const auto value = [&](std::size_t k) { return lines.value(cells[k], header[k]); };
    const auto code = [&](int k, double most) {
      if (k < 0) return 0.0;
      const double found = value(std::size_t(k));
      if (!(found >= 0 && found <= most && found == std::floor(found)))
        throw InputError(lines.at() + "column '" + header[std::size_t(k)] + "': found '" + shown(cells[std::size_t(k)]) +
                         "', expected 0 to " + number(most));
      return found;
    };
    out.line.push_back(lines.number());
    out.x.push_back({value(x), value(y)});
    out.d.push_back({value(u), value(v)});
    const double flag = flags >= 0 ? code(flags, 2) : code(mask, 1);
    const bool known = std::isfinite(out.d.back()[0] + out.d.back()[1]);
    out.status.push_back(flags >= 0 && code(mask, 1) == 1 ? VectorStatus::masked
                         : !known                        ? VectorStatus::failed
                         : flag == 2                     ? VectorStatus::replaced
                         : flag == 1                     ? VectorStatus::rejected
                                                         : VectorStatus::valid);
  }
  out.y_up = !out.x.empty() && out.x.front()[1] > out.x.back()[1];
  return out;
}

}  // namespace pivnp::io

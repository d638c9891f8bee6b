// Tables of vectors: one row a vector, columns by name in any order, separated by comma, semicolon or tab. In pixels
// x_px, y_px, u_px, v_px: (column, row) of the place and displacement from one frame to the next, row downward; in a
// length of the world x_m, y_m, u_m, v_m, y upward. Where known status (a code or name of docs/conventions.md), sigma_u
// and sigma_v (standard uncertainty of u and v, in their unit), score (correlation coefficient).
#include <cmath>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

constexpr std::array<std::string_view, 5> status_names = {"masked", "valid", "replaced", "rejected", "failed"};

VectorStatus status_of(const TextLines& lines, std::string_view cell) {
  const std::string name = column_name(cell);
  for (std::size_t k = 0; k < status_names.size(); ++k)
    if (name == status_names[k]) return VectorStatus(k);
  const double code = name.empty() || std::isalpha(static_cast<unsigned char>(name[0])) ? -1 : lines.value(cell, "status");
  if (!(code >= 0 && code < double(status_names.size()) && code == std::floor(code)))
    throw InputError(lines.at() + "column 'status': found '" + shown(cell) +
                     "', expected 0 to 4, or masked, valid, replaced, rejected or failed");
  return VectorStatus(int(code));
}

}  // namespace

ImportedVectors read_csv_vectors(const std::filesystem::path& file, std::optional<double>) {
  TextLines lines(file);
  std::string_view line = line_of_names(lines);
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  ImportedVectors out;
  out.pixels = column_of(header, {"x_px", "y_px", "u_px", "v_px"}) >= 0;
  out.y_up = !out.pixels;
  const auto needed = [&](const char* px, const char* m) {
    const int at = column_of(header, {out.pixels ? px : m});
    if (at < 0)
      throw InputError(lines.at() + "no column '" + (out.pixels ? px : m) +
                       "' among the names, expected x_px, y_px, u_px and v_px, or x_m, y_m, u_m and v_m");
    return std::size_t(at);
  };
  const std::size_t x = needed("x_px", "x_m"), y = needed("y_px", "y_m"), u = needed("u_px", "u_m"),
                    v = needed("v_px", "v_m");
  const int status = column_of(header, {"status"}), score = column_of(header, {"score"}),
            su = column_of(header, {"sigma_u"}), sv = column_of(header, {"sigma_v"});
  if ((su < 0) != (sv < 0))
    throw InputError(lines.at() + "found '" + (su < 0 ? "sigma_v" : "sigma_u") + "' alone, expected sigma_u and sigma_v");
  while (lines.next(line)) {
    if (line.empty() || line.starts_with('#')) continue;
    const std::vector<std::string_view> cells = row_of(lines, line, separator, header.size());
    const auto value = [&](std::size_t k) { return lines.value(cells[k], header[k]); };
    out.line.push_back(lines.number());
    out.x.push_back({value(x), value(y)});
    out.d.push_back({value(u), value(v)});
    if (status >= 0) out.status.push_back(status_of(lines, cells[std::size_t(status)]));
    if (su >= 0) out.sigma.push_back({value(std::size_t(su)), value(std::size_t(sv))});
    if (score >= 0) out.score.push_back(value(std::size_t(score)));
  }
  return out;
}

}  // namespace pivnp::io

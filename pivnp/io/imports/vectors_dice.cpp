// Text files of DICe, the Digital Image Correlation Engine (Output_Spec in its DICe_Schema.cpp): lines of remarks that
// begin with ***, among them the names of the two images, then a line of field names and rows, separated by commas or
// blanks. Coordinates have (0, 0) at the upper left corner of the image, y downward; displacements are those of the
// subset from the reference image to the deformed one, pixels. SIGMA is the predicted standard deviation of either
// component, by the image's noise and the lesser of the two gradients' sums; it is -1, and MATCH is not 0, where the
// correlation failed. Rows are in any order, and subsets may be missing.
#include <cmath>
#include <string_view>

#include "pivnp/core/error.hpp"
#include "pivnp/io/files/quoting.hpp"
#include "pivnp/io/imports/import_format.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

namespace {

// "*** Reference image: ./images/a.tif " -> "a.tif".
std::string named_image(std::string_view line, std::string_view label) {
  const std::size_t at = line.find(label);
  if (at == line.npos) return "";
  line.remove_prefix(at + label.size());
  line = line.substr(0, line.find_last_not_of(" \t") + 1);
  if (const std::size_t slash = line.find_last_of("/\\"); slash != line.npos) line.remove_prefix(slash + 1);
  while (line.starts_with(' ')) line.remove_prefix(1);
  return printable_part(line, 200);
}

}  // namespace

ImportedVectors read_dice(const std::filesystem::path& file, std::optional<double>) {
  TextLines lines(file);
  ImportedVectors out;
  std::string_view line;
  do {
    if (!lines.next(line)) throw InputError(file.string() + ": no line of field names, expected COORDINATE_X,COORDINATE_Y,...");
    if (const std::string name = named_image(line, "Reference image:"); !name.empty()) out.first = name;
    if (const std::string name = named_image(line, "Deformed image:"); !name.empty()) out.second = name;
  } while (line.empty() || line.starts_with("***"));
  const char separator = separator_of(line);
  const std::vector<std::string> header = header_of(line, separator);
  const auto needed = [&](const char* name, const char* printed) {
    const int at = column_of(header, {name});
    if (at < 0)
      throw InputError(lines.at() + "no field '" + printed +
                       "' among the names, expected COORDINATE_X, COORDINATE_Y, DISPLACEMENT_X and DISPLACEMENT_Y");
    return std::size_t(at);
  };
  const std::size_t x = needed("coordinate_x", "COORDINATE_X"), y = needed("coordinate_y", "COORDINATE_Y"),
                    u = needed("displacement_x", "DISPLACEMENT_X"), v = needed("displacement_y", "DISPLACEMENT_Y");
  const int sigma = column_of(header, {"sigma"}), match = column_of(header, {"match"});
  while (lines.next(line)) {
    if (line.empty()) continue;
    const std::vector<std::string_view> cells = row_of(lines, line, separator, header.size());
    const auto value = [&](std::size_t k) { return lines.value(cells[k], header[k]); };
    out.line.push_back(lines.number());
    out.x.push_back({value(x), value(y)});
    out.d.push_back({value(u), value(v)});
    const double s = sigma >= 0 ? value(std::size_t(sigma)) : 0;
    const bool good = s >= 0 && (match < 0 || value(std::size_t(match)) == 0) &&
                      std::isfinite(out.d.back()[0] + out.d.back()[1]);
    out.status.push_back(good ? VectorStatus::valid : VectorStatus::failed);
    if (sigma >= 0) out.sigma.push_back({good ? s : std::nan(""), good ? s : std::nan("")});
  }
  return out;
}

}  // namespace pivnp::io

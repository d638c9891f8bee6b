#include "pivnp/io/imports/import_format.hpp"

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"
#include "pivnp/io/imports/text_table.hpp"

namespace pivnp::io {

// Readers of motions: import_csv.cpp, import_cbgeo.cpp, import_vtk.cpp.
ImportedTable read_csv(const std::filesystem::path& file, double step);
ImportedState read_cbgeo(const std::vector<std::filesystem::path>& files);
ImportedState read_legacy_vtk(const std::vector<std::filesystem::path>& files);
ImportedState read_vtu(const std::vector<std::filesystem::path>& files);
// Readers of vectors: vectors_<name>.cpp.
ImportedVectors read_csv_vectors(const std::filesystem::path& file, std::optional<double> step);
ImportedVectors read_pivlab(const std::filesystem::path& file, std::optional<double> step);
ImportedVectors read_openpiv(const std::filesystem::path& file, std::optional<double> step);
ImportedVectors read_dice(const std::filesystem::path& file, std::optional<double> step);

Registry<FileFormat>& file_formats() {
  static Registry<FileFormat> formats = {
      {.name = "csv", .files = "tracks.csv or step_*.csv", .text = "tables of tracks: id, x, y, and a time or one file a time",
       .read_table = read_csv, .read_vectors = read_csv_vectors},
      {.name = "cbgeo", .files = "particles*.h5", .text = "CB-Geo MPM's particle tables, all ranks of a step together",
       .read_time = read_cbgeo, .several = true},
      {.name = "vtk", .files = "*_MPVector_*.vtk", .text = "Anura3D's legacy VTK files, with their siblings _MPScalar_",
       .read_time = read_legacy_vtk},
      {.name = "vtu", .files = "particles_*.vtu", .text = "MPM-Geomechanics' VTK XML files (ASCII)",
       .read_time = read_vtu},
      {.name = "history", .files = "FILE[:COLUMN]", .text = "a curve: a column of a table against its first",
       .read_curve = read_curve},
      // PIVlab deforms the second image only, OpenPIV both by half unless it is told otherwise; DICe's subsets are those
      // of the reference image.
      {.name = "pivlab", .files = "PIVlab_*.txt", .text = "PIVlab's text files", .read_vectors = read_pivlab,
       .anchor = Anchor::forward},
      {.name = "openpiv", .files = "field_*.txt", .text = "OpenPIV's text files", .read_vectors = read_openpiv},
      {.name = "dice", .files = "DICe_solution_*.txt", .text = "DICe's text files", .read_vectors = read_dice,
       .anchor = Anchor::forward},
  };
  return formats;
}

std::vector<std::string> format_names(bool (FileFormat::*kind)() const) {
  std::vector<std::string> names;
  for (const FileFormat& format : file_formats())
    if ((format.*kind)()) names.push_back(format.name);
  return names;
}

std::string formats_text(bool (FileFormat::*kind)() const) { return one_of(format_names(kind)); }

const FileFormat* format_of(const std::string& text) {
  const std::size_t at = text.find('=');
  return at == std::string::npos ? nullptr : file_formats().find(text.substr(0, at));
}

}  // namespace pivnp::io

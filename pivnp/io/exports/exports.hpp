// A record's fields in forms that other programs read.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/io/records/record.hpp"

namespace pivnp::io {

enum class ExportFormat { csv, vtu, vtkhdf };
inline constexpr std::array export_format_names{NamedValue{"csv", ExportFormat::csv}, NamedValue{"vtu", ExportFormat::vtu},
                                                NamedValue{"vtkhdf", ExportFormat::vtkhdf}};
constexpr const auto& names_of(ExportFormat) { return export_format_names; }

struct ExportOptions {
  std::vector<std::string> motions;  // left out: all; "piv" stands for the vectors (CSV only)
  std::vector<std::string> fields;   // of DerivedReader; left out: displacement and strain
  std::vector<double> times;         // nearest frame of each; left out: all
};

/// The fields that are written where none are named.
const std::vector<std::string>& exported_fields();

/// Indices of `all` nearest to the times asked for, in order, each once; all if none are.
std::vector<std::size_t> chosen_frames(const std::vector<double>& all, const std::vector<double>& asked);

/// Writes DIR/NAME.csv for each motion, a row a particle and frame, and DIR/piv.csv, a row a node and pair; what is not
/// known is an empty cell. The first line names the columns with their units. Columns of a motion: time, id, label, x0, y0,
/// x, y, status, where they are known sigma_x, sigma_y (standard uncertainty of the displacement), the fields, and the
/// comparison's difference_... at the particles of the first data set. Returns the files. Throws InputError for a motion
/// or field that is not there, RunError naming a file that cannot be written.
std::vector<std::filesystem::path> export_csv(const RecordReader& record, const ExportOptions& options,
                                              const std::filesystem::path& directory);

/// Writes DIR/NAME.vtkhdf for each motion: one file with all times, which ParaView 5.12 and later opens as it is (VTKHDF
/// 2.0, an unstructured grid of vertices). Point data: id, label, status, displacement, sigma (RMS of a component), the
/// fields, and the comparison's differences; NaN: not known. Returns the files; throws as above.
std::vector<std::filesystem::path> export_vtkhdf(const RecordReader& record, const ExportOptions& options,
                                                 const std::filesystem::path& directory);

/// Writes DIR/NAME.pvd for each motion, and the files that it lists, DIR/NAME/NAME_000000.vtu and so on, one a time: what VTK 9.1
/// and ParaView 5 read as a series. The particles that are followed then, with the same point data. Returns the .pvd files.
std::vector<std::filesystem::path> export_vtu(const RecordReader& record, const ExportOptions& options, const std::filesystem::path& directory);

}  // namespace pivnp::io

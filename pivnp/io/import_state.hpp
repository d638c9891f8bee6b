// What one time of another program's results holds, and the readers of the formats. Private to this folder's sources.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pivnp::io {

/// A field of motion_fields() beyond those that have a member: [particles][components].
struct ImportedField {
  std::string name;
  std::vector<double> values;
};

/// Arrays of one length; those a source does not know are empty.
struct ImportedState {
  std::vector<std::int64_t> id;  // empty: the position in the arrays
  std::vector<std::array<double, 2>> x, u, v, sigma;
  std::vector<double> area;
  std::vector<ImportedField> fields;
};

/// A text file in memory. Throws InputError.
std::string read_text(const std::filesystem::path& file);

/// The whole table, time by time in ascending order; one time without a column of times (`timed` false).
struct ImportedTable {
  std::vector<double> time;
  std::vector<ImportedState> state;
  bool timed = false;
};
ImportedTable read_csv(const std::filesystem::path& file, double step);

/// All ranks' files of one step.
ImportedState read_cbgeo(const std::vector<std::filesystem::path>& files);
ImportedState read_legacy_vtk(const std::filesystem::path& file);
ImportedState read_vtu(const std::filesystem::path& file);

}  // namespace pivnp::io

// File formats of other programs: one row each. Opening an import, a case's options, the command line's help and its
// messages walk this list, so that a format which is added here arrives in all of them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/record/vector_status.hpp"
#include "pivnp/core/registry.hpp"
#include "pivnp/io/imports/curve_file.hpp"

namespace pivnp::io {

/// A field of motion_fields() beyond those that have a member: [particles][components].
struct ImportedField {
  std::string name;
  std::vector<double> values;
};

/// What one time of another program's results holds. Arrays of one length; those a source does not know are empty.
struct ImportedState {
  std::vector<std::int64_t> id;  // empty: the position in the arrays
  std::vector<std::array<double, 2>> x, u, v, sigma;
  std::vector<double> area;
  std::vector<ImportedField> fields;
};

/// A whole table, time by time in ascending order; one time without a column of times (`timed` false).
struct ImportedTable {
  std::vector<double> time;
  std::vector<ImportedState> state;
  bool timed = false;
  std::string length_unit = {}, time_unit = {};  // where the file states them
};

/// Displacement vectors of one pair of frames, in the file's order. Arrays of one length, but for those that the file
/// does not know, which are empty. What is not known of one vector is NaN.
struct ImportedVectors {
  bool pixels = true;  // lengths are px, (0, 0) the centre of the image's upper left pixel; else lengths of the world
  bool y_up = false;   // y and v point upward
  std::string first, second;  // names of the two images
  std::vector<int> line;      // of the file
  std::vector<std::array<double, 2>> x, d;      // places and displacements
  std::vector<VectorStatus> status;             // empty: valid where the displacement is finite, else failed
  std::vector<std::array<double, 2>> sigma;     // standard uncertainty of the displacement
  std::vector<double> score;
};

/// A format reads motions by `read_time` or `read_table`, curves by `read_curve`, vectors by `read_vectors`. Readers throw
/// InputError naming the file and what was found and expected.
struct FileFormat {
  std::string name;   // as it stands before '=' on the command line
  std::string files;  // what its files are called
  std::string text;   // one line, no full stop
  /// One time. `several`: its files may be several (an MPI run's ranks), in the order of their names; else there is one.
  ImportedState (*read_time)(const std::vector<std::filesystem::path>& files) = nullptr;
  bool several = false;
  /// All times of one file; `step`: time from one frame or step to the next where the file counts them only.
  ImportedTable (*read_table)(const std::filesystem::path& file, double step) = nullptr;
  Curve (*read_curve)(const std::filesystem::path& file, const std::string& column, double step) = nullptr;
  /// One pair of frames; `step`: time from one frame to the next where it is known (files may hold velocities).
  ImportedVectors (*read_vectors)(const std::filesystem::path& file, std::optional<double> step) = nullptr;
  Anchor anchor = Anchor::central;  // of its vectors

  bool motion() const { return read_time || read_table; }
  bool curve() const { return read_curve != nullptr; }
  bool vectors() const { return read_vectors != nullptr; }
};

Registry<FileFormat>& file_formats();

/// Names of the formats of `kind` (&FileFormat::motion, &FileFormat::curve, &FileFormat::vectors).
std::vector<std::string> format_names(bool (FileFormat::*kind)() const);

/// The same as a sentence names them: "csv, cbgeo, vtk or vtu".
std::string formats_text(bool (FileFormat::*kind)() const);

/// The format that "FORMAT=..." begins with; nullptr where it begins with none.
const FileFormat* format_of(const std::string& text);

}  // namespace pivnp::io

// Displacement increments that another program measured, as vectors at the nodes of a grid.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"
#include "pivnp/core/record/vectors.hpp"
#include "pivnp/io/imports/import_format.hpp"

namespace pivnp::io {

/// Names of the formats that read vectors, in the order of their list (import_format.hpp).
std::vector<std::string> vector_format_names();

/// Which way y and v of a file point.
enum class VerticalAxis { format, down, up };
inline constexpr std::array vertical_axis_names{NamedValue{"format", VerticalAxis::format},
                                                NamedValue{"down", VerticalAxis::down},
                                                NamedValue{"up", VerticalAxis::up}};
constexpr const auto& names_of(VerticalAxis) { return vertical_axis_names; }

/// What a case says about them: section [vectors].
struct VectorOptions {
  std::string path = {};
  std::string format = {};
  std::optional<double> rate_hz = {};
  std::optional<Anchor> anchor = {};
  VerticalAxis y_axis = VerticalAxis::format;
  std::string length_unit = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("path", self.path,
          OptionInfo{.text = "glob (piv/*.txt) or file, one per pair of frames, in the order of the last numbers in their names"});
    visit("format", self.format, OptionInfo{.text = "program that wrote them", .names = &vector_format_names});
    visit("rate_hz", self.rate_hz,
          OptionInfo{.unit = "Hz",
                     .text = "frames per second; default: frames.rate_hz",
                     .min = 0,
                     .above_min = true});
    visit("anchor", self.anchor,
          OptionInfo{.text = "place of a vector: middle of the pair, or its first frame; default: that of the format"});
    visit("y_axis", self.y_axis,
          OptionInfo{.text = "direction of y and v in the files"});
    visit("length_unit", self.length_unit,
          OptionInfo{.text = "unit of lengths in the files: m, mm, cm, km or um; default: camera.length_unit"});
  }
};

/// The files of [vectors]. One file holds the vectors from one frame to the next; those of all files stand on one
/// regular grid, and the second image of a file is the first of the next, where the files name them.
class VectorFiles {
 public:
  /// Reads all files once. `options.path` is relative to `base`. `rate_hz`: frames per second where they are known.
  /// Throws InputError "FILE:LINE: found ..., expected ...": what cannot be read, uneven spacing, another grid than the
  /// first file's, a place given twice, pairs that are not in turn; and where no file or format is named so.
  VectorFiles(const VectorOptions& options, const std::filesystem::path& base, std::optional<double> rate_hz);

  const std::vector<std::filesystem::path>& files() const { return files_; }
  /// True: lengths are px, the world's (column, -row) with (0, 0) the centre of the image's upper left pixel; false:
  /// those of the files, y upward. A length axis that points downward is turned over about the grid's own middle.
  bool pixels() const { return pixels_; }
  const Grid& grid() const { return grid_; }
  /// One more than files; of files that name no images "frame 1" and so on.
  const std::vector<std::string>& frame_names() const { return frame_names_; }
  /// True if the first file states standard uncertainties.
  bool states_uncertainty() const { return states_uncertainty_; }

  /// Vectors of one pair on grid(), y upward, in its unit. Nodes without a vector are masked. Covariance, score and
  /// correlation length that the file does not state are NaN. Throws InputError as the constructor.
  VectorField read(std::size_t index) const;

 private:
  ImportedVectors checked(std::size_t index) const;
  VectorField placed(const ImportedVectors& vectors, std::size_t index) const;

  FileFormat format_;
  VerticalAxis y_axis_;
  Anchor anchor_;
  std::optional<double> step_;
  std::vector<std::filesystem::path> files_;
  bool pixels_ = true, y_up_ = false, states_uncertainty_ = false;
  double y_sum_ = 0;  // least and greatest y of the first file
  std::size_t count_ = 0;
  Grid grid_;
  std::vector<std::string> frame_names_;
};

}  // namespace pivnp::io

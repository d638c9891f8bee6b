// Which files a frame path means.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/record/remark.hpp"

namespace pivnp::image {

/// Natural order: runs of digits compare as numbers (img_2 before img_10), everything else byte by byte. Names that
/// differ only in leading zeros come with fewer zeros first.
bool natural_less(std::string_view a, std::string_view b);

/// Files in order, with their numbers: 0, 1, 2 ... for a glob or folder; the numbers in the names for a printf pattern.
struct FrameFiles {
  struct File {
    std::int64_t number;
    std::filesystem::path path;
  };
  std::vector<File> files;           // increasing number, at least one
  std::vector<double> clock = {};    // of each, steps between frames since the first; empty: the numbers
  std::vector<Remark> remarks = {};  // what the names leave open

  /// Original frames, those that are missing in between included.
  std::int64_t count() const { return files.back().number - files.front().number + 1; }
  /// The file of original frame `index` (0 = first found), or nullptr if it is missing.
  const std::filesystem::path* find(std::int64_t index) const;
};

/// A file name with one %d, %Nd or %0Nd; %% is a per cent sign.
class NumberedName {
 public:
  /// Nothing if there is no such conversion in `name`. Throws InputError if there are several.
  static std::optional<NumberedName> parse(const std::string& name, const std::string& what);
  /// `sign`: characters that the sign of a negative number has beside the width (printf: 0).
  std::string name(std::int64_t number, std::size_t sign = 0) const;
  /// The number in `file_name`, if it is exactly one that name() makes.
  /// A negative number has its sign before the digits, padded with or without it.
  std::optional<std::int64_t> number(const std::string& file_name) const;

 private:
  std::string before_, after_;
  std::size_t width_ = 0;
  char pad_ = ' ';
};

/// Every image (by the name's ending) in a folder. Throws InputError if there is none.
FrameFiles files_in_folder(const std::filesystem::path& folder, const std::string& what);
/// Throws InputError if nothing matches.
FrameFiles files_of_pattern(const std::filesystem::path& folder, const NumberedName& name, const std::string& what);
/// `pattern` relative to `base` (or absolute), wildcards in any of its parts; an image's ending in small or capital
/// letters. Throws InputError if nothing matches.
FrameFiles files_of_glob(const std::filesystem::path& base, const std::string& pattern, const std::string& what);

}  // namespace pivnp::image

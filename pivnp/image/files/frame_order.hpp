// The order in time of files that are numbered by their names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pivnp/core/record/remark.hpp"

namespace pivnp::image {

struct TimeOrder {
  std::vector<std::filesystem::path> files;
  /// When each was taken, in steps between frames; 0, 1, 2 ... but where the numbers skip.
  std::vector<double> clock;
  /// What the names leave open, and how they were read.
  std::vector<Remark> remarks;
};

/// By the numbers in the names, the folders' names first. A minus sign counts where the names of one pattern have it in
/// part, or where all have it behind no letter or digit; a point or comma between two numbers is a decimal one unless
/// the second numbers are those of a count (1.8, 1.9, 1.10). Where a single number counts the files and most of its
/// steps are the same, the clock keeps the steps that are longer.
TimeOrder in_time_order(std::vector<std::filesystem::path> files);

}  // namespace pivnp::image

// The folder of drawn frames: what they were drawn from, so that no run measures another's.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"

namespace pivnp::app {

/// FOLDER/drawn.txt says of which case, by which program, and (once all are drawn) which files with which content. Until
/// then FOLDER/drawing.txt names those that are drawn.
class DrawnFrames {
 public:
  DrawnFrames(const Case& c, std::filesystem::path folder);

  static std::string name(int frame);  // frame_00000.png
  const std::filesystem::path& folder() const { return folder_; }

  /// True if all frames of the case lie there as they were drawn; false if there are none, or not all, or changed
  /// ones. Throws InputError if they were drawn from another case or by another program: a run that goes on needs its
  /// own.
  bool complete() const;
  /// Removes frames that were drawn there before. Throws InputError where frames lie that were not drawn.
  void begin() const;
  /// A frame that is about to be drawn is this program's, whenever it is killed.
  void draws(int frame) const;
  void finish() const;

 private:
  std::string head() const;

  std::filesystem::path folder_;
  int count_;
  std::string case_text_;
};

}  // namespace pivnp::app

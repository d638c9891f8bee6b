// Filters of frames before correlation: which of them lower the error on a case's own footage.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/filter.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

struct FilterTrial {
  std::string keys;  // "high_pass_px = 16"; empty: without any
  std::string name;  // "high_pass", for files
  image::FilterOptions options;
  double rms_px = 0;    // error of a component, over the vectors that are valid with the filter and without
  double plain_px = 0;  // the same vectors' without
  double valid = 0;     // share of the vectors asked for
  bool helps = false;
};

/// The truth is a frame of the case that is carried by known fields (methods/known_pairs.hpp), while what does not move
/// with the material stays: the light as it is in that frame and in the next one (blurred by 32 px), and the fixed
/// pattern that two backgrounds, of the sequence's halves, have in common. A background is tried only where the
/// material moves by more than `least_path_px` within half of the sequence, since texture that stays is background. A
/// filter helps if the error of the vectors falls by a twentieth without fewer of them being valid, or a fiftieth more
/// are valid and the error does not grow by that.
struct FilterTrials {
  std::string made_of;              // one sentence
  FilterTrial plain;                // without any filter
  std::vector<FilterTrial> trials;  // each alone; at last those that help together, where several do
  std::string left_out;             // why no background was tried; empty: it was
  image::FilterOptions best;        // nothing where nothing helps
};
inline constexpr double least_path_px = 8;

FilterTrials try_filters(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                         Progress& progress);

/// A filter of a case's frames. Its background is read from the frames.
image::FrameFilter filter_of(const image::FilterOptions& options, image::FrameSource& source);

/// From now on frames of `setting` are filtered as [preprocess] says. Returns what was chosen, where the case leaves the choice open.
std::vector<std::string> set_filter(const Case& c, image::FrameSource& source, int threads, Progress& progress,
                                    Setting& setting);

/// One sentence on the truth, and one on each filter.
std::vector<std::string> words_of(const FilterTrials& trials);

}  // namespace pivnp::app

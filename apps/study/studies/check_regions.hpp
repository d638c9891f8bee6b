// Where the regions of a case go along its frames, for the pictures of a check.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/measure/moving_outline.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/core/record/remark.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

struct RegionsInFrame {
  int frame = 0;
  std::vector<MovingOutline> outlines;
};

struct RegionsAlongFrames {
  std::vector<RegionsInFrame> seen;  // the first frame, one in the middle, the last one; empty where regions are not followed
  std::vector<Remark> remarks;
};

/// Follows the regions by the method `fast`, as a run follows them by its own (MovingRegions), through as many frames as some
/// seconds allow, by their pixels: the picture of the last one is then an earlier one, which is said.
RegionsAlongFrames regions_along_frames(const Case& c, const Setting& setting, image::FrameSource& source, int threads, Progress& progress);

}  // namespace pivnp::app

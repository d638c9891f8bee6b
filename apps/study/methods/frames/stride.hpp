// Pairs further apart where motion is slow.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// Of the frames those that are used where each step is to move by frames.least_motion_px: the first frame, then the
/// first at which a tenth of the material (90th percentile of |displacement|, measured coarsely and directly from the
/// frame used last) has moved so far, and the last frame. A frame that has lost its correlation with the one used last
/// (less than half of the usual share of vectors is valid) is not stepped to where the frame before it can be. Reads
/// every frame once, in order. Times stay those of the frames.
std::vector<int> frames_by_motion(const Case& c, const Setting& setting, image::FrameSource& source, int threads,
                                  Progress& progress);

/// The source itself where frames.least_motion_px is 0, else those of its frames.
std::unique_ptr<image::FrameSource> strided_by_motion(const Case& c, std::unique_ptr<image::FrameSource> source,
                                                      int threads, Progress& progress);

/// How many frames were left out; nothing where none was to be.
std::vector<std::string> stride_remarks(const Case& c, std::size_t all, std::size_t used);

}  // namespace pivnp::app

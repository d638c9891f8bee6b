// The frames of a case, drawn or opened.
#pragma once

#include <memory>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/settings.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames.hpp"

namespace pivnp::app {

/// Opens the frames of a case; those of a [synth] case are drawn first (a resumed run keeps what it has). Fills in
/// c.frames with the full path. nullptr if the case has no frames. Throws as image::open_frames and synthesize.
std::unique_ptr<image::FrameSource> case_frames(Case& c, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

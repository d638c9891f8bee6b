// The frames of a case, drawn or opened.
#pragma once

#include <memory>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/io/files/directory_lock.hpp"

namespace pivnp::app {

/// Opens the frames of a case; those of a [synth] case are drawn first (a resumed run keeps what it has, if all of
/// it was drawn from this case). Fills in c.frames with the full path. nullptr if the case has no frames. `held`: as in
/// synthesize(). Throws as image::open_frames and synthesize, and InputError where a resumed run finds others' frames.
std::unique_ptr<image::FrameSource> case_frames(Case& c, const RunSettings& settings, Progress& progress,
                                                const io::DirectoryLock* held = nullptr);

}  // namespace pivnp::app

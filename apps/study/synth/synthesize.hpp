// `pivnp synth`: frames with known truth.
#pragma once

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/io/files/directory_lock.hpp"

namespace pivnp::app {

/// Draws the frames of a [synth] case into OUT/frames/*.png and their truth into OUT/truth/record.h5: the motion "truth",
/// at the seeds that the case's own particles start from, and, where material points carry the texture (a simulation or
/// its record), their own motion "material", unchanged. Frames that were drawn there before go; others are refused
/// (DrawnFrames). `held`: OUT's lock, where the caller has it; nullptr: taken while drawing.
void synthesize(const Case& c, const RunSettings& settings, Progress& progress,
                const io::DirectoryLock* held = nullptr);

}  // namespace pivnp::app

// `pivnp synth`: frames with known truth.
#pragma once

#include "apps/case/case.hpp"
#include "apps/study/pipeline/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// Draws the frames of a [synth] case into OUT/frames/*.png and their truth into OUT/truth/record.h5 (motion "truth",
/// at the seeds that the case's own particles start from).
void synthesize(const Case& c, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

// From a finished record to its report.
#pragma once

#include <optional>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/record/comparison.hpp"
#include "pivnp/image/frames/frames.hpp"

namespace pivnp::app {

/// Adds to the outcome's remarks what the record and the comparison say. If `draw`, writes report.html, report.pdf and
/// figures/ into `directory` and names them in `outcome`. `source`: the frames, or nullptr where they are not to be had
/// (the report then shows vectors without a picture).
void tell_record(const Case& c, RunOutcome& outcome, std::optional<Comparison> comparison, image::FrameSource* source,
                 const std::filesystem::path& directory, bool draw);

}  // namespace pivnp::app

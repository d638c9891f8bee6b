// `pivnp check`: does the case fit its frames, and does it mean what its author thinks?
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/settings.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

struct CheckOutcome {
  std::filesystem::path picture;
  std::vector<std::string> remarks;  // the case's size, and what the first frame shows, one sentence each
};

/// Validates a case against its frames and what its simulation asks for, and draws OUT/check.png: the first frame with
/// grid, masks, regions, boundaries and a scale bar; with [vectors] alone the same without a frame. Where nothing is
/// measured nothing is drawn (`picture` is empty). A check that fails leaves no file or folder behind.
CheckOutcome check_case(const Case& c, const RunSettings& settings, Progress& progress);

}  // namespace pivnp::app

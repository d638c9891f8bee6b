// The simulation where its schemes are known to fail.
#pragma once

#include <vector>

#include "apps/study/stress/survival_map.hpp"

namespace pivnp::app {

/// A run a combination. Right: within 5 % of the greatest displacement (rms) of what is known, or of the same on finer cells by the
/// default scheme; wrong: more than 20 % without a warning. A run that stops with its reason, or is doubted beforehand, is flagged.
std::vector<MapPlan> mpm_maps();

}  // namespace pivnp::app

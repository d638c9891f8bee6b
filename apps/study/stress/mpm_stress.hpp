// The simulation where its schemes are known to fail: steps over the limit, few points, cells that are crossed, bulk stiffness.
#pragma once

#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// A column that collapses, a run a combination. Right: within 5 % of the greatest displacement, rms, of the same with small steps, the
/// points and the stiffness asked for, by the default scheme on finer cells; wrong: more than 20 % without a word. A run that stops with its reason is flagged.
std::vector<SurvivalMap> mpm_stress(int threads, Progress& progress);

}  // namespace pivnp::app

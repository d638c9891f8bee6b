// The comparison's verdicts from easy to hopeless.
#pragma once

#include <vector>

#include "apps/study/stress/survival_map.hpp"

namespace pivnp::app {

/// Pairs of motions whose difference is known, in units of the standard uncertainty u_val that they state. Judged is what is said of the
/// RMS of displacement at the end: told apart where there is no difference, or not where there are four u_val and more, is wrong; in
/// between both may be said. Flagged: no verdict, or more than a tenth of the first motion without a partner.
std::vector<MapPlan> compare_maps();

}  // namespace pivnp::app

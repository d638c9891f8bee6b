// Image correlation on drawn texture, from easy to hopeless.
#pragma once

#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/piv/options.hpp"

namespace pivnp::app {

/// Right: less than .1 px off; wrong: more than .5 px (length of the error). Frames of `side` px, nodes 16 px apart; a node that was
/// rejected keeps what was measured, so that flags can be held against errors. Small grains move by 1.7 px where nothing else is said.
std::vector<SurvivalMap> piv_stress(const piv::PivOptions& options, int side, int seeds, int threads, Progress& progress);

}  // namespace pivnp::app

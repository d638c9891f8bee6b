// Settings of [mpm] on the generalised vortex, whose motion is known.
#pragma once

#include "apps/study/frontier/front.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// Every shape function and transfer on three sizes of cells, the default with other numbers of points and other steps. Error: rms
/// displacement at the turning point, against the motion that the body force was made for. `repeats`: runs of each, the median counts.
FrontierStage vortex_frontier(int repeats, int threads, Progress& progress);

}  // namespace pivnp::app

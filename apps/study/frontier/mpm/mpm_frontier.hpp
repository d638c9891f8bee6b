// Settings of [mpm] on a case of the user's: error against time, by its own refinement.
#pragma once

#include "apps/study/frontier/front.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/progress.hpp"

namespace pivnp::app {

/// The case's simulation with every shape function and transfer worth having, on its own cells and on cells twice as
/// large; its own setting with other numbers of points and other steps. The truth is the case's own setting on cells half as large: error is the RMS over material points of the
/// distance between their displacement at `end` (s) and the mean of the truth's points that lay in their square at the start. What
/// could not be run to the end is left out, with its reason.
FrontierStage mpm_frontier(const Case& c, const Setting& setting, double end, int repeats, int threads, Progress& progress);

}  // namespace pivnp::app

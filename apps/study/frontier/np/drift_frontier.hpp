// Schemes of np.drift on drawn frames: error of the paths at the end against time.
#pragma once

#include "apps/study/frontier/front.hpp"
#include "apps/study/frontier/np/np_frontier.hpp"
#include "pivnp/piv/options.hpp"

namespace pivnp::app {

/// Frames of blobs that a simple shear and an even shift carry (no more of either from frame to frame than `followed` has, and none
/// that leaves the frame), measured once by `piv`; then every scheme follows the same vectors. Time is that of following, drawing and
/// correlation of neighbouring frames left out.
FrontierStage drift_frontier(const np::NpOptions& base, const piv::PivOptions& piv, const Followed& followed, int repeats, int threads, Progress& progress);

}  // namespace pivnp::app

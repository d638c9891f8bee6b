// Image correlation from easy to hopeless.
#pragma once

#include <vector>

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/scene.hpp"
#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/progress.hpp"
#include "pivnp/image/frames/frames.hpp"
#include "pivnp/piv/options.hpp"

namespace pivnp::app {

/// On drawn texture. Right: less than .1 px off; wrong: more than .5 px (length of the error). Frames of `side` px, nodes 16 px apart; a
/// node that was rejected keeps what was measured, so that flags can be held against errors. Small grains move by 1.7 px where nothing
/// else is said.
std::vector<MapPlan> piv_maps(const piv::PivOptions& options, int side, int seeds);

/// Beside a free surface and a wall at rest: the vectors of the row of nodes that is nearest to it, on the material's side.
std::vector<MapPlan> piv_edge_maps(const piv::PivOptions& options, int seeds);

/// On the texture of the case's own frames, carried by known fields (known_pairs.hpp). Throws InputError as that does.
std::vector<MapPlan> piv_own_maps(const Case& c, const Setting& setting, image::FrameSource& source, int threads, Progress& progress);

}  // namespace pivnp::app

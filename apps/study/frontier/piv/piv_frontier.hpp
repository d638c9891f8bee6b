// Settings of [piv] against known pairs: error and resolution against time.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/study/frontier/front.hpp"
#include "apps/study/frontier/piv/piv_choices.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"

namespace pivnp::app {

/// All of piv_choices(), or those of `only`; `own`: the case's setting is marked, and added if it is
/// none of them. Every pair is measured `repeats` times by each setting, settings in turn, on `threads` threads; a repeat's
/// time is the median over the pairs, and of these the median, the least and the most are given. Settings of which more vectors are rejected (by .02 of the nodes) are on no front.
///
/// Error: root mean square over the pairs of the rms error of the worse component over valid vectors among the nodes scored. Wave-length at
/// 90 %: where the share of a wave that is found passes .9, between the waves of the known pairs on a logarithmic scale (NaN: the longest is
/// damped more; the shortest: none is). Noise: standard deviation of the worse component in the even shift. Their product is the metrological
/// efficiency indicator of the displacement (px^2, less is better; Grediac & Sur 2017, DIC Challenge 2.0).
/// `first_compared`: pairs before it do not count in errors and shares.
FrontierStage piv_frontier(const KnownPairs& known, const piv::PivOptions& base, bool own, int repeats, int threads, Progress& progress,
                           const std::vector<PivChoice>& only = {}, std::size_t first_compared = 0);

}  // namespace pivnp::app

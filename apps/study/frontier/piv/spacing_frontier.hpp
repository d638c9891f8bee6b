// Node spacing against known pairs: error of the field between the nodes against time.
#pragma once

#include <functional>
#include <string>

#include "apps/study/frontier/front.hpp"
#include "apps/study/methods/frames/known_pairs.hpp"
#include "pivnp/np/options.hpp"

namespace pivnp::app {

/// The spacing of a case's nodes, and what the case says for another one ("grid.spacing_px=16").
struct SpacingKey {
  double px = 0;  // 0: a quarter of the window, as a case has that says nothing
  std::function<std::string(double px)> key = {};
};

/// The default, `fast` and `fft` with windows of 16 to 64 px and nodes an eighth of the window to a whole window apart (4 px or more),
/// and the case's own where `own`; not those with fewer than four nodes across what is scored. Numerical particles (`np`: their shape functions), four about each node scored, at places that no
/// spacing has for its own, read the field of each pair; errors, shares and wave-lengths (piv_frontier()) are those of what they
/// read. The error of reading between the nodes is thus in them, which no figure at the nodes shows. Places: valid where the
/// particle can be followed.
FrontierStage spacing_frontier(const KnownPairs& known, const piv::PivOptions& base, const np::NpOptions& np, const SpacingKey& given, bool own,
                               int repeats, int threads, Progress& progress);

}  // namespace pivnp::app

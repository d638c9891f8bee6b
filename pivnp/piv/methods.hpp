// The correlation methods, one row each: whatever picks, offers, names or measures methods asks this list.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pivnp/core/registry.hpp"
#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sampling/extent.hpp"

namespace pivnp::piv {

/// How a method finds its vectors.
enum class MethodFamily {
  window_search,      // windows, each size searched over all lags
  window_refinement,  // windows, the last size only about what larger ones found
  gauss_newton,       // the dense field by Gauss-Newton on shared warps
  other,
};

struct PivMethod {
  std::string name;  // as `piv.method` has it
  std::string text;  // one line: which it is, and when to take it
  MethodFamily family = MethodFamily::other;
  int finest = 1;  // decimation of the images that its vectors are measured on
  std::unique_ptr<Method> (*make)(const PivOptions& options, const Extent& extent, int threads) = nullptr;
  // What it demands: PairCorrelator refuses options and masks that it cannot take.
  std::vector<Anchor> anchors = {Anchor::central, Anchor::forward};
  bool masks = true;  // pixels can be left out
  int least_window_px = 8;
};

/// The first row is the recommended one ("default").
Registry<PivMethod>& piv_methods();

}  // namespace pivnp::piv

// The charts of a sweep.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "apps/report/figures/figure.hpp"
#include "apps/study/sweep/plan.hpp"

namespace pivnp::app {

struct Swing {
  std::string key, least, most;  // values at the ends
  double lower = 0, upper = 0, own = 0;
  double sigma = std::numeric_limits<double>::quiet_NaN();  // standard uncertainty of `own`; NaN: not known
};
/// Of each key, how far the response goes over its values and the case's own; the widest first. Runs that failed do not count.
std::vector<Swing> swings(std::size_t response, const std::vector<Variation>& variations, const std::vector<SweepRun>& runs);

/// The responses between which a tornado chart `width_mm` wide has its bars and the values at their ends.
std::pair<double, double> tornado_span(const std::vector<Swing>& swings, double width_mm);
report::Figure tornado(const SweepResponse& response, const std::vector<Swing>& swings);
/// The response over the values of variation `x`, a curve for each combination of the others.
report::Figure curves(const SweepResponse& response, std::size_t index, std::size_t x, const std::vector<Variation>& variations,
                      const std::vector<SweepRun>& runs);
/// Are all of its values numbers, and more than one?
bool numeric(const Variation& v);
/// Distance and speed of the zone against time; `shown`: at most eight.
report::Figure histories(const std::string& name, const std::string& what, const std::vector<const SweepRun*>& shown);
/// A field of each run at its end, on one scale.
report::Figure mosaic(const std::string& field, const std::vector<const SweepRun*>& shown);

}  // namespace pivnp::app

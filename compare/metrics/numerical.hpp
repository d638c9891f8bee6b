// The numerical uncertainty of every metric by itself, from the same metric on coarser grids.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

/// Adds, in squares, u_num to the uncertainty of every difference that does not hold the grid's error particle by particle
/// already. `coarser`: the metrics of the first against the second on one or two coarser grids, the
/// finer one first; `ratio`: of the spacings. A metric that a coarser grid does not have stays as it is. Gives the names
/// of those that are out of the asymptotic range with three grids (grid_convergence), where u_num is the range over the
/// grids and no bound.
std::vector<std::string> add_numerical(std::vector<Metric>& metrics, const std::vector<std::vector<Metric>>& coarser,
                                       double ratio);

}  // namespace pivnp::compare

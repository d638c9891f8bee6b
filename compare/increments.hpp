// Differences of increments: what the sides do from one time to the next, free of what went before.
#pragma once

#include <vector>

#include "compare/compare.hpp"

namespace pivnp::compare {

/// Adds the metrics increment_median and increment_p95: median and 95th percentile, over particles and steps between
/// consecutive common times, of |d(u_second - u_first)|, over all compared particles, or those whose material position
/// lies outside the circle `outside` = (x, y, radius). With `reference_increment` > 0 (mean increment of the reference
/// material on the first side) also increment_median_relative. `x0`: material positions in the order of the fields.
void add_increment_metrics(const DifferenceField& x, const DifferenceField& y, std::size_t times,
                           const std::vector<Vec2>& x0, const std::vector<double>& outside, double reference_increment,
                           const std::string& unit, std::vector<Metric>& metrics);

}  // namespace pivnp::compare

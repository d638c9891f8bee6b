// A difference held against its standard uncertainty.
#pragma once

#include <cstddef>
#include <string>

#include "compare/data/statistics.hpp"
#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

/// What one comparison says of a metric.
struct MetricValue {
  double value = not_known;
  double uncertainty = not_known;
  std::string note = "";  // ends the definition: when, how uncertain
  Verdict verdict = Verdict::none;
  double factor = not_known;  // of a difference: so many uncertainties are distinguishable
};

/// A difference between the data sets, E = S - D, held against its standard uncertainty u_val (V&V 20): less than `k`
/// of them is not distinguishable. Beyond it no word is said: E is then the model's error to within u_val.
/// What is shown of every difference beside that: within which tolerance it lies, and what would have been found
/// (Metric::within, Metric::seen).
MetricValue difference(double value, double uncertainty, std::string note, double k = 2);

/// Factor for the greatest of `count` errors: exceeded by none of them in 95 of 100 cases, however the two components
/// of each share its variance and whether or not the errors are independent: sqrt(2 ln(20 count)), at least 2.
double greatest_factor(std::size_t count);

/// The same for paths of particles, whose errors have longer tails than normal ones (an edge, a lost texture). Twice the factor
/// above: 92 % of 16 twin experiments on looks that the table of docs/verdicts.md does not use stay below 1.7 times it.
double greatest_of_paths_factor(std::size_t count);

/// The same for the 95th percentile: where neighbours share their errors, it may be the greatest of twenty independent
/// ones.
double percentile_factor(std::size_t count);

}  // namespace pivnp::compare

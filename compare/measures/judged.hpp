// A difference held against its standard uncertainty.
#pragma once

#include <cstddef>
#include <string>

#include "pivnp/core/record/metric.hpp"

namespace pivnp::compare {

/// The only words a verdict may hold, beside none.
inline constexpr const char* within_limit = "within limit";
inline constexpr const char* over_limit = "over limit";
inline constexpr const char* not_distinguishable = "not distinguishable at this u_val";

/// A difference between the sides, E = S - D, judged against its standard uncertainty u_val (V&V 20): less than `k` of
/// them is not distinguishable. Beyond it no word is said: E is then the model's error to within u_val.
Metric difference_metric(std::string name, double value, std::string unit, double uncertainty, std::string definition,
                         double k = 2);

/// Factor for the greatest of `count` errors: exceeded by none of them in 95 of 100 cases, however the two components
/// of each share its variance and whether or not the errors are independent: sqrt(2 ln(20 count)), at least 2.
double greatest_factor(std::size_t count);

/// The same for the 95th percentile: where neighbours share their errors, it may be the greatest of twenty independent
/// ones.
double percentile_factor(std::size_t count);

}  // namespace pivnp::compare

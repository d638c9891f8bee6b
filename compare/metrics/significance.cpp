#include "compare/metrics/significance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pivnp::compare {

MetricValue difference(double value, double uncertainty, std::string note, double k) {
  const bool lost = std::abs(value) < k * uncertainty;  // false where the uncertainty is not known
  return {value, uncertainty, std::move(note), lost ? Verdict::not_distinguishable : Verdict::none, k};
}

double greatest_of_paths_factor(std::size_t count) { return 2 * greatest_factor(count); }

double percentile_factor(std::size_t count) { return greatest_factor(std::min<std::size_t>(count, 20)); }

double greatest_factor(std::size_t count) {
  return std::max(2.0, std::sqrt(2 * std::log(20.0 * double(std::max<std::size_t>(1, count)))));
}

}  // namespace pivnp::compare

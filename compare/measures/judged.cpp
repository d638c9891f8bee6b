#include "compare/measures/judged.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pivnp::compare {

double percentile_factor(std::size_t count) { return greatest_factor(std::min<std::size_t>(count, 20)); }

double greatest_factor(std::size_t count) {
  return std::max(2.0, std::sqrt(2 * std::log(20.0 * double(std::max<std::size_t>(1, count)))));
}

Metric difference_metric(std::string name, double value, std::string unit, double uncertainty,
                         std::string definition, double k) {
  const bool lost = std::abs(value) < k * uncertainty;  // false where the uncertainty is not known
  return {std::move(name), value, std::move(unit), uncertainty, std::move(definition), lost ? not_distinguishable : ""};
}

}  // namespace pivnp::compare

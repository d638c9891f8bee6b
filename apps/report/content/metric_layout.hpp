// The metrics of a comparison laid out to be read: many of them are members of families, which a table shows at once.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "pivnp/core/record/metric.hpp"

namespace pivnp::report {

/// Statistics of one difference: mean in x (or the mean of a scalar), in y, RMS, 95th percentile, maximum; nullptr: none.
struct StatisticsRow {
  std::string stem;   // the members' names without the statistic: "displacement", "displacement_final_over_u"
  std::array<const Metric*, 5> members{};
  const Metric& any() const;  // RMS where there is one
};

/// One quantity of the first and the second data set, and its difference; nullptr: none.
struct BothRow {
  std::string stem;
  const Metric *first = nullptr, *second = nullptr, *difference = nullptr;
  const Metric& any() const;  // the difference where there is one
};

struct MetricLayout {
  std::vector<StatisticsRow> statistics;
  std::vector<BothRow> both;
  std::vector<const Metric*> single;
};

/// Every metric once, families in the order of their first member. `metrics` must outlive it.
MetricLayout layout_of(const std::vector<Metric>& metrics);

}  // namespace pivnp::report

// A statistic that several stages need.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace pivnp::app {

/// The upper one of the two in the middle where their number is even; `if_none` for no value at all.
inline double median(std::vector<double> values, double if_none = 0) {
  if (values.empty()) return if_none;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace pivnp::app

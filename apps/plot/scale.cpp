#include "apps/plot/scale.hpp"

#include <algorithm>
#include <cmath>

#include "apps/plot/numbers.hpp"

namespace pivnp::plot {

Scale scale_for(const std::vector<double>& values, bool signed_values) {
  Scale s;
  double least = quantile(values, 0), greatest = quantile(values, 1);
  if (!std::isfinite(least) || !std::isfinite(greatest)) {
    if (signed_values) s = {Colours::diverging, -1, 1};
    return s;
  }
  double low = quantile(values, 0.005), high = quantile(values, 0.995);
  const double round_off =
      1e-6 * std::max(std::abs(least), std::abs(greatest));  // of single precision: no other side of zero
  for (double* value : {&least, &greatest, &low, &high})
    if (std::abs(*value) < round_off) *value = 0;
  if (least >= low - 0.05 * (high - low)) low = least;
  if (greatest <= high + 0.05 * (high - low)) high = greatest;
  if (signed_values || (least < 0 && greatest > 0)) {
    s.map = Colours::diverging;
    s.upper = std::max(std::abs(low), std::abs(high));
    s.lower = -s.upper;
  } else {
    s.lower = low > 0 && low < 0.7 * high ? 0 : low;
    s.upper = high < 0 && high > 0.7 * low ? 0 : high;
  }
  if (!(s.upper > s.lower)) {  // one value everywhere
    const double about = s.upper == 0 ? 1 : std::abs(s.upper) * 0.1;
    s.lower = s.map == Colours::diverging || s.upper != 0 ? s.upper - about : 0;
    s.upper += about;
  }
  const double slack = 1e-9 * (s.upper - s.lower);
  s.below = least < s.lower - slack;
  s.above = greatest > s.upper + slack;
  return s;
}

Scale scale_of_magnitude(const std::vector<double>& values) {
  Scale s = scale_for(values, false);
  if (s.lower > 0) s.lower = 0, s.below = false;
  return s;
}

}  // namespace pivnp::plot

#include "compare/increments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/statistics.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::compare {

void add_increment_metrics(const DifferenceField& x, const DifferenceField& y, std::size_t times,
                           const std::vector<Vec2>& x0, const std::vector<double>& outside, double reference_increment,
                           const std::string& unit, std::vector<Metric>& metrics) {
  const std::size_t n = x0.size();
  Quantile magnitude;
  std::size_t counted = 0;
  for (std::size_t p = 0; p < n; ++p) {
    if (!outside.empty() && (x0[p] - Vec2(outside[0], outside[1])).norm() <= outside[2]) continue;
    for (std::size_t k = 1; k < times; ++k) {
      const std::size_t now = k * n + p, before = now - n;
      const double d = std::hypot(double(x.values[now]) - double(x.values[before]),
                                  double(y.values[now]) - double(y.values[before]));
      if (!std::isfinite(d)) continue;
      magnitude.add(d);
      ++counted;
    }
  }
  if (counted == 0) return;
  const std::string over =
      "of |d(u_second - u_first)| over particles and steps between consecutive common times" +
      (outside.empty() ? std::string()
                       : ", material positions further than " + number(outside[2]) + " " + unit + " from (" +
                             number(outside[0]) + ", " + number(outside[1]) + ")");
  const double unknown = std::numeric_limits<double>::quiet_NaN(), median = magnitude.at(0.5);
  metrics.push_back({"increment_median", median, unit, unknown, "median " + over, ""});
  metrics.push_back({"increment_p95", magnitude.at(0.95), unit, unknown, "95th percentile " + over, ""});
  if (reference_increment > 0)
    metrics.push_back({"increment_median_relative", median / reference_increment, "1", unknown,
                       "increment_median over the mean increment of the reference material on the first side", ""});
}

}  // namespace pivnp::compare

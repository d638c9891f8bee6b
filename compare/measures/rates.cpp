#include "compare/measures/rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pivnp/core/text.hpp"

namespace pivnp::compare {

namespace {

// Weights of the three values whose sum is the parabola's slope at the middle time.
std::array<double, 3> slope_weights(double t0, double t1, double t2) {
  const double h0 = t1 - t0, h1 = t2 - t1;
  return {-h1 / (h0 * (h0 + h1)), (h1 - h0) / (h0 * h1), h0 / (h1 * (h0 + h1))};
}

}  // namespace

Rates::Rates(const std::vector<Vec2>& X, std::vector<double> outside, std::size_t times)
    : outside_(std::move(outside)), counted_(X.size(), 1), over_time_(X.size(), times), series_(5) {
  if (!outside_.empty())
    for (std::size_t p = 0; p < X.size(); ++p)
      counted_[p] = (X[p] - Vec2(outside_[0], outside_[1])).norm() > outside_[2];
}

void Rates::add(double time, const std::vector<Vec2>& u_first, const std::vector<Vec2>& difference,
                const std::vector<Vec2>& variance) {
  if (held_.size() == 3) {
    std::rotate(held_.begin(), held_.begin() + 1, held_.end());
    held_.pop_back();
  }
  held_.push_back({time, u_first, difference, variance});
  if (held_.size() >= 2) add_increments();
  if (held_.size() == 3) add_velocities();
}

void Rates::add_increments() {
  const std::vector<Vec2>&now = held_.back().difference, &before = held_[held_.size() - 2].difference;
  for (std::size_t p = 0; p < now.size(); ++p) {
    if (!counted_[p]) continue;
    const double d = (now[p] - before[p]).norm();
    if (!std::isfinite(d)) continue;
    increments_.add(d);
    any_increment_ = true;
  }
}

void Rates::add_velocities() {
  const std::array<double, 3> w = slope_weights(held_[0].time, held_[1].time, held_[2].time);
  DisplacementStatistics here;
  for (std::size_t p = 0; p < counted_.size(); ++p) {
    const auto rate = [&](std::vector<Vec2> State::*values) -> Vec2 {
      return w[0] * (held_[0].*values)[p] + w[1] * (held_[1].*values)[p] + w[2] * (held_[2].*values)[p];
    };
    const Vec2 d = rate(&State::difference);
    if (!d.allFinite()) continue;
    const Vec2 variance = w[0] * w[0] * held_[0].variance[p] + w[1] * w[1] * held_[1].variance[p] +
                          w[2] * w[2] * held_[2].variance[p];
    velocity_.add(d, variance.x(), variance.y());
    here.add(d, variance.x(), variance.y());
    over_time_.add(p, d);
    peak_first_ = std::max(peak_first_, rate(&State::u_first).norm());
  }
  const bool any = here.count() > 0;
  const std::array<double, 5> row{any ? here.bias().x() : not_known, any ? here.bias().y() : not_known,
                                  any ? here.rms() : not_known, any ? here.p95() : not_known,
                                  any ? here.max() : not_known};
  for (std::size_t s = 0; s < row.size(); ++s) series_[s].push_back(row[s]);
}

std::vector<Series> Rates::velocity_series(const std::string& length_unit, const std::string& time_unit) const {
  const std::string unit = length_unit + "/" + time_unit;
  static const std::array<const char*, 5> names{"bias_x", "bias_y", "rms", "p95", "max"};
  static const std::array<const char*, 5> words{"mean of v_x of the second minus that of the first",
                                                "mean of v_y of the second minus that of the first",
                                                "RMS over the particles of |v_second - v_first|",
                                                "95th percentile of |v_second - v_first|",
                                                "greatest |v_second - v_first|"};
  std::vector<Series> out;
  for (std::size_t s = 0; s < names.size(); ++s) {
    std::vector<double> values{not_known};
    values.insert(values.end(), series_[s].begin(), series_[s].end());
    values.push_back(not_known);
    out.push_back({"velocity_" + std::string(names[s]), unit, words[s], std::move(values)});
  }
  return out;
}

void Rates::add_increment_metrics(double reference_increment, const std::string& unit,
                                  std::vector<Metric>& metrics) const {
  if (!any_increment_) return;
  const std::string over =
      "of |d(u_second - u_first)| over particles and steps between consecutive common times" +
      (outside_.empty() ? std::string()
                        : ", material positions further than " + number(outside_[2]) + " " + unit + " from (" +
                              number(outside_[0]) + ", " + number(outside_[1]) + ")");
  const double median = increments_.at(0.5);
  metrics.push_back({"increment_median", median, unit, not_known, "median " + over, ""});
  metrics.push_back({"increment_p95", increments_.at(0.95), unit, not_known, "95th percentile " + over, ""});
  if (reference_increment > 0)
    metrics.push_back({"increment_median_relative", median / reference_increment, "1", not_known,
                       "increment_median over the mean increment of the reference material on the first side", ""});
}

}  // namespace pivnp::compare

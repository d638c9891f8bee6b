#include "compare/measures/rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pivnp::compare {

namespace {

// Weights of the three values whose sum is the parabola's slope at the middle time.
std::array<double, 3> slope_weights(double t0, double t1, double t2) {
  const double h0 = t1 - t0, h1 = t2 - t1;
  return {-h1 / (h0 * (h0 + h1)), (h1 - h0) / (h0 * h1), h0 / (h1 * (h0 + h1))};
}

// One statistic of velocity over the particles at one time.
struct VelocityStatistic {
  const char *name, *definition;
  double (*value)(const VectorStatistics&);
};

const std::vector<VelocityStatistic>& velocity_statistics() {
  static const std::vector<VelocityStatistic> rows{
      {"velocity_bias_x", "mean of v_x of the second minus that of the first",
       [](const VectorStatistics& d) { return d.bias().x(); }},
      {"velocity_bias_y", "mean of v_y of the second minus that of the first",
       [](const VectorStatistics& d) { return d.bias().y(); }},
      {"velocity_rms", "RMS over the particles of |v_second - v_first|",
       [](const VectorStatistics& d) { return d.rms(); }},
      {"velocity_p95", "95th percentile of |v_second - v_first|", [](const VectorStatistics& d) { return d.p95(); }},
      {"velocity_max", "greatest |v_second - v_first|", [](const VectorStatistics& d) { return d.max(); }}};
  return rows;
}

}  // namespace

Rates::Rates(const std::vector<Vec2>& X, std::vector<double> outside, std::size_t times)
    : outside_(std::move(outside)), counted_(X.size(), 1), over_time_(X.size(), times),
      statistics_(velocity_statistics().size()) {
  if (!outside_.empty())
    for (std::size_t p = 0; p < X.size(); ++p)
      counted_[p] = (X[p] - Vec2(outside_[0], outside_[1])).norm() > outside_[2];
}

void Rates::add(double time, const std::vector<Vec2>& u_first, const std::vector<Vec2>& difference,
                const std::vector<Vec2>& variance, const std::vector<Vec2>& numerical) {
  if (held_.size() == 3) {
    std::rotate(held_.begin(), held_.begin() + 1, held_.end());
    held_.pop_back();
  }
  held_.push_back({time, u_first, difference, variance, numerical});
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
  }
}

void Rates::add_velocities() {
  const std::array<double, 3> w = slope_weights(held_[0].time, held_[1].time, held_[2].time);
  VectorStatistics here;
  for (std::size_t p = 0; p < counted_.size(); ++p) {
    const auto rate = [&](std::vector<Vec2> State::*values) -> Vec2 {
      return w[0] * (held_[0].*values)[p] + w[1] * (held_[1].*values)[p] + w[2] * (held_[2].*values)[p];
    };
    const Vec2 d = rate(&State::difference);
    if (!d.allFinite()) continue;
    const Vec2 variance = w[0] * w[0] * held_[0].variance[p] + w[1] * w[1] * held_[1].variance[p] +
                          w[2] * w[2] * held_[2].variance[p] + rate(&State::numerical).cwiseAbs2();
    velocity_.add(d, variance.x(), variance.y());
    here.add(d, variance.x(), variance.y());
    over_time_.add(p, d);
    peak_first_ = std::max(peak_first_, rate(&State::u_first).norm());
  }
  for (std::size_t s = 0; s < statistics_.size(); ++s)
    statistics_[s].push_back(here.count() > 0 ? velocity_statistics()[s].value(here) : not_known);
}

std::vector<ComparisonTable::Column> Rates::velocity_columns(const std::string& length_unit,
                                                             const std::string& time_unit) const {
  std::vector<ComparisonTable::Column> out;
  for (std::size_t s = 0; s < statistics_.size(); ++s) {
    const VelocityStatistic& row = velocity_statistics()[s];
    std::vector<double> values{not_known};
    values.insert(values.end(), statistics_[s].begin(), statistics_[s].end());
    values.push_back(not_known);
    out.push_back({row.name, length_unit + "/" + time_unit, std::move(values), row.definition});
  }
  return out;
}

}  // namespace pivnp::compare

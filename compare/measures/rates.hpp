// what the data sets do from one common time to the next: increments, and velocities as differences of displacement.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/data/statistics.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// Fed with one common time after another; holds three of them. Velocity is the derivative at the middle one of the
/// parabola through all three, on both data sets alike, whatever one of them knows better: the same filter on both. It is known
/// at every common time but the first and the last.
class Rates {
 public:
  /// `X`: material positions in the order of the fields; `outside`: circle (x, y, radius) whose inside takes no part in
  /// the statistics of increments; empty: none.
  Rates(const std::vector<Vec2>& X, std::vector<double> outside, std::size_t times);

  /// `u_first`, `difference`: in the order of the fields, NaN where not compared; `variance`: of the difference but for
  /// `numerical`, NaN if not known; `numerical`: the signed error of the second's grid, which is one and the same from
  /// time to time and is differentiated like the difference.
  void add(double time, const std::vector<Vec2>& u_first, const std::vector<Vec2>& difference,
           const std::vector<Vec2>& variance, const std::vector<Vec2>& numerical);

  // Differences of velocity over space and time, and one statistic a time (first and last: NaN). The variance is the
  // sum of that of the two outer differences over the time between them: a bound for errors that do not oppose.
  const VectorStatistics& velocity() const { return velocity_; }
  double peak_first() const { return peak_first_; }  // greatest speed of the first
  /// Columns velocity_bias_x, _bias_y, _rms, _p95, _max of the table over_space.
  std::vector<ComparisonTable::Column> velocity_columns(const std::string& length_unit,
                                                        const std::string& time_unit) const;
  const OverTime& over_time() const { return over_time_; }

  /// Quantile over particles and steps between consecutive common times of |d(u_second - u_first)|; NaN without any.
  double increment(double q) const { return increments_.at(q); }
  const std::vector<double>& outside() const { return outside_; }

 private:
  struct State {
    double time = 0;
    std::vector<Vec2> u_first, difference, variance, numerical;
  };
  void add_increments();
  void add_velocities();

  std::vector<double> outside_;
  std::vector<std::uint8_t> counted_;  // 1: takes part in the statistics of increments
  std::vector<State> held_;            // oldest first, at most three
  Quantile increments_;
  VectorStatistics velocity_;
  OverTime over_time_;
  double peak_first_ = 0;
  std::vector<std::vector<double>> statistics_;  // by the rows of velocity_statistics()
};

}  // namespace pivnp::compare

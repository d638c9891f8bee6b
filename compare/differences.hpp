// Second minus first, particle by particle, one common time after another.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "compare/alignment.hpp"
#include "compare/compare.hpp"
#include "compare/side.hpp"
#include "compare/statistics.hpp"

namespace pivnp::compare {

/// What one common time, or all of them together, amount to.
struct Tally {
  DisplacementStatistics displacement;
  ScalarStatistics strain_dev, strain_vol;
  double sum_first = 0, sum_second = 0;         // of |u|
  double peak_first = 0, peak_second = 0;       // greatest |u|
  double peak_first_sigma = not_known, peak_second_sigma = not_known;
  std::array<double, 2> sum_cov_trace{0, 0};    // NaN where a side does not know its covariance
  double floor_dev = not_known, floor_vol = not_known;  // noise floor of the strain difference (StillZone)
  std::array<Vec2, 2> shift{Vec2::Zero(), Vec2::Zero()};  // what the reference took off, first and second

  double rms_sigma(std::size_t side) const { return std::sqrt(sum_cov_trace[side] / double(displacement.count())); }
};

class Differences {
 public:
  /// `paired`: the first's particles with a partner at the common start, in the order of the fields.
  Differences(std::vector<std::size_t> paired, const std::string& length_unit);

  /// One more common time. Particles of the first that are no longer followed, or have lost their partner, are left
  /// out; if that leaves none, nothing is added and the answer is false. A side's covariance enters where it is known.
  bool add(const SideState& first, const SideState& second, const std::vector<Partner>& partners,
           const std::array<Vec2, 2>& shift);

  const Tally& total() const { return total_; }
  const Tally& last() const { return last_; }
  bool cov_known(std::size_t side) const { return cov_known_[side]; }

  std::vector<DifferenceField> take_fields() { return std::move(fields_); }
  std::vector<Series> take_series() { return std::move(series_); }

 private:
  void add_series();

  std::vector<std::size_t> paired_;
  Tally total_, last_;
  std::array<bool, 2> cov_known_{true, true};  // at every time so far
  std::vector<DifferenceField> fields_;
  std::vector<Series> series_;
};

}  // namespace pivnp::compare

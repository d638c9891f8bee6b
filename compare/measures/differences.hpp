// Second minus first, particle by particle, one common time after another.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "compare/data/statistics.hpp"
#include "compare/measures/budget.hpp"
#include "compare/measures/comparison.hpp"
#include "compare/measures/rates.hpp"
#include "pivnp/core/record/strain_note.hpp"

namespace pivnp::compare {

/// What the records state with their strains, first and second side; nothing where they state nothing. A noise floor
/// stated there is the side's; otherwise it is sought where the side stands still.
using StrainNotes = std::array<std::optional<StrainNote>, 2>;

/// What one common time, or all of them together, amount to.
struct Tally {
  DisplacementStatistics displacement;
  ScalarStatistics strain_dev, strain_vol, strain_path;
  double sum_first = 0, sum_second = 0;    // of |u|
  double peak_first = 0, peak_second = 0;  // greatest |u|
  double peak_first_sigma = not_known, peak_second_sigma = not_known;
  std::array<double, 2> sum_cov_trace{0, 0};  // NaN where a side does not know its covariance
  double sum_measurement = 0, sum_numerical = 0, sum_input = 0;  // traces of the parts of u_val^2
  double floor_dev = not_known, floor_vol = not_known, floor_path = not_known;  // noise floors (StillZone)
  std::array<RigidFit, 2> frame;  // what the reference took off, first and second

  /// RMS error of each side's displacements, of what is known; 0 if nothing is. Camera, gauge and frame of reference are
  /// the first's, numerics and inputs the second's.
  std::array<double, 2> known_sigma() const;
  double rms_part(double sum) const { return std::sqrt(sum / double(displacement.count())); }
};

/// The particles compared at the last time, both sides in the frame of the comparison.
struct Snapshot {
  std::vector<std::size_t> particle;  // of the first side
  std::vector<Vec2> X, u_first, u_second;
  std::vector<double> dev_first, dev_second;  // deviatoric strain, NaN where F is not positive
  std::vector<Vec2> variance;                 // u_val^2, NaN if not known
};

class Differences {
 public:
  /// `paired`: the first's particles with a partner at the common start, in the order of the fields; `times`: how many
  /// common times there may be.
  Differences(std::vector<std::size_t> paired, const std::vector<Vec2>& X, std::size_t times,
              const CompareOptions& options, const StrainNotes& notes, const std::string& length_unit,
              const std::string& time_unit);

  /// One more common time. Particles of the first that are no longer followed, or have lost their partner, are left
  /// out; if that leaves none, nothing is added and the answer is false. A side's covariance enters where it is known.
  bool add(const SideState& first, const SideState& second, const std::vector<Partner>& partners,
           const std::array<RigidFit, 2>& frame, const std::vector<Vec2>& numerical);

  const Tally& total() const { return total_; }
  const Tally& last() const { return last_; }
  const Snapshot& snapshot() const { return snapshot_; }
  const Rates& rates() const { return rates_; }
  bool cov_known(std::size_t side) const { return cov_known_[side]; }
  const std::vector<std::size_t>& paired() const { return paired_; }

  /// Moves the fields, series and their times into `out`.
  void take(Comparison& out);

 private:
  struct Sample;
  void add_particle(std::size_t row, const Sample& a, const Sample& b, const Variance& variance);
  double path_step(std::vector<Mat2>& before, std::size_t row, const Mat2& F, std::vector<double>& path);
  void add_series();
  bool keeps_fields() const;

  std::vector<std::size_t> paired_;
  std::vector<Vec2> X_;  // of the paired
  std::string length_unit_, time_unit_;
  std::size_t times_, time_index_ = 0, rows_kept_;
  Budget budget_;
  StrainNotes notes_;
  Tally total_, last_;
  Snapshot snapshot_;
  Rates rates_;
  OverTime over_displacement_, over_strain_;
  std::array<bool, 2> cov_known_{true, true};  // at every time so far
  std::array<std::vector<Mat2>, 2> F_before_;
  std::array<std::vector<double>, 2> path_;
  std::vector<std::uint8_t> begun_;
  std::vector<double> field_time_;
  std::vector<DifferenceField> fields_;
  std::vector<Series> series_;
};

}  // namespace pivnp::compare

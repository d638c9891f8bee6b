// Second minus first, particle by particle, one common time after another.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/rigid.hpp"
#include "compare/data/sources.hpp"
#include "compare/data/statistics.hpp"
#include "compare/measures/rates.hpp"
#include "compare/uncertainty/budget.hpp"
#include "compare/uncertainty/field_mean.hpp"
#include "compare/uncertainty/strain_errors.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// What one common time, or all of them together, amount to.
struct Tally {
  VectorStatistics displacement;
  ScalarStatistics strain_dev, strain_vol, strain_path;
  double sum_first = 0, sum_second = 0;    // of |u|
  double peak_first = 0, peak_second = 0;  // greatest |u|
  double peak_first_sigma = not_known, peak_second_sigma = not_known;
  PerDataSet<double> sum_cov_trace{0, 0};  // NaN where a data set does not know its covariance
  double sum_measurement = 0, sum_numerical = 0, sum_input = 0;  // traces of the parts of u_val^2
  double sum_grid = 0;                     // of sum_numerical, what coarser grids tell
  // Noise floors of strain: of all data sets that measure, and of those of them that state no covariance of F.
  double floor_dev = not_known, floor_vol = not_known, floor_path = not_known;
  double rest_dev = not_known, rest_vol = not_known, rest_path = not_known;
  Vec2 sum_gauge = Vec2::Zero();  // of what averaging over the gauge would change: dev, vol
  PerDataSet<RigidFit> frame;  // what the reference took off, first and second

  /// RMS error of each data set's displacements, of what is known; 0 if nothing is. Camera, gauge and frame of reference are
  /// the first's, numerics (as given: grids tell of each metric by themselves) and inputs the second's.
  PerDataSet<double> known_sigma() const;
  /// Root mean square over the particles of the standard uncertainty of a difference of deviatoric strain.
  double dev_uncertainty() const { return strain_uncertainty(strain_dev.rms_uncertainty(), rest_dev, floor_dev); }
  double rms_part(double sum) const { return std::sqrt(sum / double(displacement.count())); }
};

/// The particles compared at the last time, both data sets in the frame of the comparison.
struct ComparedParticles {
  std::vector<std::size_t> particle;  // of the first data set
  std::vector<Vec2> X, u_first, u_second;
  std::vector<double> dev_first, dev_second;  // deviatoric strain, NaN where F is not positive
  std::vector<Vec2> variance;                 // u_val^2, NaN if not known
  std::vector<Vec2> random;                   // of it, both data sets' covariances; NaN: none is known
  std::vector<Vec2> strain_first, strain_second;  // dev, vol
  std::vector<StrainError> strain_error;
};

class Differences {
 public:
  /// `paired`: the first's particles with a partner at the common start, in the order of the fields; `times`: how many
  /// common times there may be; `clock`: standard uncertainty of the second's clock, where it was set by an onset.
  Differences(std::vector<std::size_t> paired, const DataSet& first, std::size_t times, const CompareOptions& options,
              const StrainNotes& notes, double clock);

  /// One more common time. Particles of the first that are no longer followed, or have lost their partner, are left
  /// out; if that leaves none, nothing is added and the answer is false. A data set's covariance enters where it is known.
  bool add(const DataSetState& first, const DataSetState& second, const std::vector<Partner>& partners,
           const PerDataSet<RigidFit>& frame, const std::vector<Vec2>& numerical);

  const Tally& total() const { return total_; }
  const Tally& last() const { return last_; }
  const ComparedParticles& last_particles() const { return last_particles_; }
  const Rates& rates() const { return rates_; }
  /// Standard uncertainty of the mean displacement difference by how far errors are shared; nothing where that is not
  /// known (compare.correlation_m, or the records' gauge length).
  std::optional<Vec2> mean_uncertainty(bool last) const;
  /// The difference at the last time, weighted by how well each particle is known.
  std::optional<FieldMean::Weighted> weighted() const;
  /// Standard uncertainty of the mean difference of strain (dev, vol) by its particles' own, as that of the displacement.
  std::optional<Vec2> mean_strain_uncertainty(bool last) const;
  /// The difference of strain at the last time by such weights: 0 deviatoric, 1 volumetric, as the x component; nothing
  /// without covariances of F.
  std::optional<FieldMean::Weighted> weighted_strain(int which) const;
  double strain_gauge() const { return strain_errors_.gauge(); }
  bool cov_F_known(std::size_t set) const { return cov_F_known_[set]; }
  double correlation_length() const { return correlation_; }  // NaN: not known
  bool cov_known(std::size_t set) const { return cov_known_[set]; }
  /// Whether a data set's noise floor was taken in the zone that the comparison declares.
  bool floor_in_zone(std::size_t set) const { return floor_in_zone_[set]; }
  const std::vector<std::size_t>& paired() const { return paired_; }

  /// The times added so far.
  const std::vector<double>& times() const { return time_; }
  /// Differences at the times for which fields are kept: difference_x, _y, _magnitude, _strain_dev. Then over the times
  /// of each particle, one row of values at the last: over_time_displacement_bias_x, _bias_y, _rms, _p95, _max,
  /// over_time_velocity_rms, _p95, _max, over_time_strain_dev_bias, _rms, _p95, _max. The former are moved out.
  std::vector<ComparisonField> take_fields();
  /// Statistics over the particles, time by time: the table over_space.
  ComparisonTable over_space() const;

 private:
  struct Sample;
  struct Field;
  static const std::vector<Field>& difference_fields();
  void add_particle(std::size_t row, const Sample& a, const Sample& b, const Variance& variance, const StrainError& strain);
  std::vector<StrainError> strain_errors(const DataSetState& first, const DataSetState& second,
                                         const std::vector<Partner>& partners, const std::vector<PartnerState>& at) const;
  void add_floors(const PerDataSet<bool>& known, const PerDataSet<StillZone>& still);
  double path_step(std::vector<Mat2>& before, std::size_t row, const Mat2& F, std::vector<double>& path);
  bool keeps_fields() const;
  void find_correlation(const PerDataSet<bool>& known);

  std::vector<std::size_t> paired_;
  std::vector<std::int64_t> id_;  // of the paired
  std::vector<Vec2> X_;
  std::string length_unit_, time_unit_;
  std::size_t most_times_, rows_kept_;
  Budget budget_;
  StrainNotes notes_;
  Tally total_, last_;
  ComparedParticles last_particles_;
  Rates rates_;
  FieldMean mean_total_, mean_last_, strain_mean_total_, strain_mean_last_;
  StrainErrors strain_errors_;
  double clock_, given_correlation_, correlation_ = not_known;
  std::vector<Vec2> second_before_, strain_before_;  // the second's displacements and strains at the time before
  OverTime over_displacement_, over_strain_;
  PerDataSet<bool> cov_known_{true, true}, cov_F_known_{true, true};  // at every time so far
  std::vector<std::uint8_t> zone_;          // 1: in the zone that is declared to stand still; empty: none is
  PerDataSet<bool> floor_in_zone_{false, false};
  PerDataSet<std::vector<Mat2>> F_before_;
  PerDataSet<std::vector<double>> path_;
  std::vector<std::uint8_t> begun_;
  std::vector<double> time_, field_time_;
  std::vector<std::vector<float>> fields_;       // by the rows of difference_fields()
  std::vector<std::vector<double>> statistics_;  // by the rows of statistics_over_space()
};

}  // namespace pivnp::compare

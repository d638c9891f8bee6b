// Shear bands of both data sets, and how far the strongest are apart.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/measures/differences.hpp"
#include "compare/shapes/ridges.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

struct BandMeasures {
  double threshold = 0;                       // deviatoric strain
  PerDataSet<std::vector<ShearBand>> bands;   // strongest (length times strain) first
  // Half the change when the threshold moves by the noise floor; NaN: unknown (variances of single particles do not tell how many
  // ridges their noise makes).
  PerDataSet<double> number_uncertainty{};
  double floor_dev = 0;                       // that noise floor, NaN if it is not known
  double gauge = 0;                           // greatest gauge length of both, 0 if none is stated

  /// The first's strongest against the nearest of those of the second that are at least half as strong as its strongest
  /// (conjugate bands are alike, and chance says which is the stronger), second minus first; nothing where a data set has
  /// none, or where what both show of it, along the line between them, is shorter than four spacings or crosses by 30 degrees and more.
  /// All but the choice is of that stretch. Uncertainties: half a particle spacing of each and the gauge length of measured strains
  /// (rectangular), over the length for the angle; the longest step in time on each, and what averaging takes off the strain at the
  /// threshold over its rate there.
  struct Difference {
    double offset = 0;  // mean distance between the ridges
    double inclination_deg = 0, thickness = 0, onset = 0, peak = 0, slip = 0;
    double place_uncertainty = 0, inclination_uncertainty_deg = 0, onset_uncertainty = 0;
    double peak_uncertainty = 0, slip_uncertainty = 0;  // by the strain's own uncertainty along both ridges; NaN: unknown
  };
  std::optional<Difference> strongest;

  /// Tables bands_first and bands_second, a row a band; none where there is none.
  std::vector<ComparisonTable> tables(const std::string& length_unit, const std::string& time_unit) const;
  /// "shear bands (ridges ...)", for definitions.
  std::string words() const;
};

/// Notes when each particle first reaches the threshold, and finds the bands of both data sets at the end.
class Bands {
 public:
  Bands(double threshold, const DataSet& first, const DataSet& second);
  void add(const DataSetState& first, const DataSetState& second);
  /// Data sets as at the last common time, and what that amounts to; `gauge`: the length over which measured strains are
  /// averaged, 0 if none is stated.
  BandMeasures measure(const DataSet& first, const DataSet& second, const Tally& last, double gauge) const;

 private:
  double threshold_;
  PerDataSet<std::vector<double>> onset_, rate_;  // rate: of the strain as it reached the threshold
  PerDataSet<std::vector<double>> before_;        // strain at the time before
  double time_ = std::numeric_limits<double>::quiet_NaN(), longest_step_ = 0;
};

}  // namespace pivnp::compare

// Shear bands of both data sets, and how far the strongest are apart.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/shapes/ridges.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

struct BandMeasures {
  double threshold = 0;                       // deviatoric strain
  PerDataSet<std::vector<ShearBand>> bands;   // strongest (length times strain) first
  PerDataSet<double> number_uncertainty{};    // half the change when the threshold moves by the noise floor; NaN: unknown
  double floor_dev = 0;                       // that noise floor, NaN if it is not known
  double gauge = 0;                           // greatest gauge length of both, 0 if none is stated

  /// The first's strongest against the nearest of those of the second that are at least half as strong as its strongest
  /// (conjugate bands are alike, and chance says which is the stronger), second minus first; nothing where a data set has
  /// none, or where the two cross by 30 degrees and more. Uncertainties: half a particle spacing of each and the gauge length of measured strains (rectangular), over the
  /// length for the angle, and the longest step in time on each.
  struct Difference {
    double offset = 0;  // mean distance between the ridges
    double inclination_deg = 0, thickness = 0, onset = 0, peak = 0, slip = 0;
    double place_uncertainty = 0, inclination_uncertainty_deg = 0, onset_uncertainty = 0;
    double peak_uncertainty = 0, slip_uncertainty = 0;  // by the noise floor; NaN: unknown
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
  /// Data sets as at the last common time. `floor_dev`: the noise floor of strain, NaN if it is not known; `gauge`: the
  /// length over which measured strains are averaged, 0 if none is stated.
  BandMeasures measure(const DataSet& first, const DataSet& second, const PerDataSet<RigidFit>& frame, double floor_dev,
                       double gauge) const;

 private:
  double threshold_;
  PerDataSet<std::vector<double>> onset_;
  double time_ = std::numeric_limits<double>::quiet_NaN(), longest_step_ = 0;
};

}  // namespace pivnp::compare

// The standard uncertainty of strain differences: the data sets' covariances of F, averaging over a gauge length, noise
// floors.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/sources.hpp"
#include "compare/data/statistics.hpp"
#include "compare/uncertainty/gauge.hpp"

namespace pivnp::compare {

/// Of one particle at one time. Strains: deviatoric, volumetric.
struct StrainError {
  Vec2 random = Vec2::Zero();  // variances by the covariances of F, NaN: one of them is not known there
  Vec2 gauge = Vec2::Zero();   // what averaging would change, with its sign
  Vec2 late = Vec2::Zero();    // what the clock's uncertainty is worth

  Vec2 common() const { return gauge.cwiseAbs2() + late.cwiseAbs2(); }
  Vec2 variance() const { return random + common(); }
};

/// A strain's uncertainty from its particles' own (0: no covariance tells any), and from the noise floors: `rest` of
/// those data sets that measure and know no covariance of F (NaN: one of them knows no floor either), `floor` of all
/// that measure. What still material shows is the least that errors can be; it stands alone where a particle's own are
/// not known.
inline double strain_uncertainty(double own, double rest, double floor) {
  const double u = std::hypot(own, rest);
  return floor > u || std::isnan(own) ? floor : u;
}

class StrainErrors {
 public:
  /// `X`: material positions by row. A data set whose note states a gauge length averages over it, and the other, which
  /// does not (or over less), is averaged likewise to see what that changes: exactly the difference of two data sets
  /// that are one and the same but for it.
  StrainErrors(const std::vector<Vec2>& X, const StrainNotes& notes);

  double gauge() const { return gauge_; }  // side of the averages; 0: both average alike
  /// One common time. `F`: of both data sets by row, NaN where not compared; `row`: covariances of a row of F, empty
  /// where a data set states none.
  std::vector<StrainError> of(const PerDataSet<std::vector<Mat2>>& F,
                              const PerDataSet<std::vector<std::array<double, 3>>>& row) const;

 private:
  double gauge_ = 0;
  std::size_t averaged_ = 0;  // the data set that is averaged
  GaugeAverage average_;
};

}  // namespace pivnp::compare

// Histories of material points: where they go on both data sets, and what that says.
#pragma once

#include <string>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/options.hpp"
#include "compare/measures/history.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

/// Of every point k (from 1) that is followed on both data sets: |u| as the history point_k with the distance of the
/// displacements, and the table point_k of both displacements.
struct PointMeasures {
  std::vector<HistoryMeasures> histories;
  std::vector<ComparisonTable> tables;
  std::vector<std::string> lost;  // places of the others: "(1, 2)"
};

class PointHistories {
 public:
  /// `options.points_m`: material positions at the common start. A point further than half a spacing from the
  /// material of a data set has no history there. Data sets as read at the common start.
  PointHistories(const CompareOptions& options, const DataSet& first, const DataSet& second);

  /// The data sets' present states. A point that has lost one of the particles that carry it is carried by those left,
  /// and ends (NaN) once it is outside their material.
  /// `numerical`: variances at the first's particles, from coarser grids (empty without).
  void add(const DataSetState& first, const DataSetState& second, const PerDataSet<RigidFit>& frame,
           const std::vector<Vec2>& numerical);

  PointMeasures measure(const std::string& length_unit, const std::string& time_unit) const;

 private:
  struct Track {
    Partner place;
    std::vector<Vec2> u;
    double variance = 0;  // trace of the covariance, mean over the times where known
    std::size_t known = 0;
  };
  PerDataSet<const DataSet*> sets_;
  double given_ = 0, gauge_;  // trace of the variance that is given as numbers; relative uncertainty of lengths
  std::vector<Vec2> points_;
  PerDataSet<std::vector<Track>> tracks_;
  std::vector<double> shared_;  // trace of the variance of frame of reference and numerics, summed over the times
  std::vector<double> time_;
};

}  // namespace pivnp::compare

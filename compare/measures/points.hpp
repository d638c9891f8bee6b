// Histories of material points: where they go on both sides, and what that says.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/alignment/partners.hpp"
#include "compare/alignment/reference.hpp"
#include "compare/data/data_set.hpp"
#include "compare/data/options.hpp"
#include "compare/measures/comparison.hpp"

namespace pivnp::compare {

class PointHistories {
 public:
  /// `options.points_m`: material positions at the common start. A point further than half a spacing from a side's
  /// material has no history there. Sides as read at the common start.
  PointHistories(const CompareOptions& options, const Side& first, const Side& second);

  /// The sides' present states. A point that has lost one of the particles that carry it is carried by those left,
  /// and ends (NaN) once it is outside their material.
  /// `numerical`: variances at the first's particles, from coarser grids (empty without).
  void add(const SideState& first, const SideState& second, const std::array<RigidFit, 2>& frame,
           const std::vector<Vec2>& numerical);

  /// Per point k (from 1): metrics point_k_* of |u| (history.hpp), point_k_distance_rms, and the table point_k.
  void finish(const std::string& length_unit, const std::string& time_unit, Comparison& out) const;

 private:
  struct Track {
    Partner place;
    std::vector<Vec2> u;
    double variance = 0;  // trace of the covariance, mean over the times where known
    std::size_t known = 0;
  };
  std::array<const Side*, 2> sides_;
  double given_ = 0, gauge_;  // trace of the variance that is given as numbers; relative uncertainty of lengths
  std::vector<Vec2> points_;
  std::array<std::vector<Track>, 2> tracks_;
  std::vector<double> shared_;  // trace of the variance of frame of reference and numerics, summed over the times
  std::vector<double> time_;
};

}  // namespace pivnp::compare

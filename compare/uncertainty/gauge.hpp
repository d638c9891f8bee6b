// What averaging over the gauge length of the other data set changes in a strain.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// Averages over squares about places that do not move: cells of a fifth of the side are counted as wholes, five by
/// five.
class GaugeAverage {
 public:
  GaugeAverage() = default;  // of nothing: of() gives what it gets
  GaugeAverage(const std::vector<Vec2>& X, double side);

  bool given() const { return !cell_.empty(); }
  /// Means of F about each place; those that are not finite are left out.
  std::vector<Mat2> of(const std::vector<Mat2>& F) const;

 private:
  std::vector<int> cell_;                     // of each place
  std::vector<std::vector<int>> neighbours_;  // of each cell that holds one, itself too
};

}  // namespace pivnp::compare

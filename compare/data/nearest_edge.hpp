// The nearest of many short line segments.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// Point of the segment a-b nearest to x: its parameter in [0, 1] from a to b (0 for a == b).
double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& x);

/// Segments in square buckets, each entered wherever a point within its reach can lie.
class NearestEdge {
 public:
  struct Hit {
    int edge = -1;  // -1: none within reach
    double parameter = 0, distance = 0;
  };

  /// `reach[e]`: a point further than this from segment e is not near it.
  void build(const std::vector<std::array<int, 2>>& edges, const std::vector<Vec2>& points, std::vector<double> reach);
  Hit find(const Vec2& x) const;

 private:
  std::int64_t column(double x) const;
  static std::uint64_t key(std::int64_t i, std::int64_t j);

  double cell_ = 1;
  std::vector<std::array<Vec2, 2>> segments_;
  std::vector<double> reach_;
  std::unordered_map<std::uint64_t, std::vector<int>> buckets_;
};

}  // namespace pivnp::compare

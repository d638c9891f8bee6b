// Linear triangles on scattered nodes: Delaunay triangulation, and which triangle a place is in.
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::np {

class Triangulation {
 public:
  /// Delaunay triangles of `points` (CGAL; exact predicates; points that coincide count once). Fewer than three points,
  /// or all on one line: no triangle.
  explicit Triangulation(const std::vector<Vec2>& points);

  struct Triangle {
    std::array<int, 3> node;       // indices into the points, counter-clockwise
    std::array<int, 3> neighbour;  // across the side opposite to node k; -1: none
    double longest = 0;            // side, length
  };
  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// The triangle that holds `x`, sides included; -1 outside the hull. On a side shared by two it is the same one
  /// whatever was asked before (the walk starts from a triangle that belongs to the place).
  int locate(const Vec2& x) const;

 private:
  void sort_into_bins();
  std::vector<Vec2> points_;
  std::vector<Triangle> triangles_;
  Vec2 lower_ = Vec2::Zero();
  double bin_ = 1;
  int bins_x_ = 0, bins_y_ = 0;
  std::vector<int> start_;  // a triangle near each bin's centre
};

}  // namespace pivnp::np

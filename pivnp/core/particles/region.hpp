// Where material is: simple polygons in the world.
#pragma once

#include <string>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp {

/// Of a list of pairs (x, y), as options give them.
std::vector<Vec2> positions_of(const Points& points);

/// A simple polygon (no self-crossing, non-zero area), vertices in either sense, the last joined to the first.
class Polygon {
 public:
  /// Throws InputError naming `what` if there are fewer than three vertices, two sides cross, or the area is zero.
  Polygon(std::vector<Vec2> vertices, const std::string& what);

  const std::vector<Vec2>& vertices() const { return vertices_; }
  double area() const { return area_; }  // > 0
  Vec2 lower() const { return lower_; }
  Vec2 upper() const { return upper_; }
  /// True inside and on the boundary.
  bool contains(const Vec2& x) const;
  /// Area of the overlap with the box [lower, upper].
  double overlap(const Vec2& box_lower, const Vec2& box_upper) const;
  /// Distance from `x` to the nearest side, and that side's outward normal.
  double distance(const Vec2& x, Vec2& outward_normal) const;

 private:
  std::vector<Vec2> vertices_;  // counter-clockwise
  double area_ = 0;
  Vec2 lower_, upper_;
};

/// A named piece of material at the first frame.
struct Region {
  std::string name;
  Polygon polygon;
};

}  // namespace pivnp

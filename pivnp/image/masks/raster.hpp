// Polygons and circles as runs of pixels.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::image {

/// Columns first..last of one row, both included, cut to the image.
struct Run {
  int first, last;
};

/// The pixels of row `row` whose centres lie inside a simple polygon or on its boundary (within 1e-9 px). Runs may
/// overlap. `runs` is overwritten.
void polygon_runs(const std::vector<Vec2>& vertices_px, int row, int width, std::vector<Run>& runs);

/// The same for a circle.
void circle_runs(const Vec2& centre_px, double radius_px, int row, int width, std::vector<Run>& runs);

}  // namespace pivnp::image

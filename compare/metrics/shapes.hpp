// The body's shape at the last common time: outline, slope, crest, mobilised material.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "compare/data/data_set.hpp"
#include "compare/data/triangulation.hpp"
#include "compare/measures/comparison.hpp"
#include "compare/measures/differences.hpp"

namespace pivnp::compare {

/// Both sides at their beginning (as material) and at the last time compared (as sides).
struct Shapes {
  const MaterialMesh &start_first, &start_second;
  const Side &first, &second;
};

/// Adds the outlines for drawing and the metrics of shape: outline_iou, outline_hausdorff_95, mobilised_area; with
/// slope_base_m also run-out, crest height, crest retreat and slope angle.
void add_shapes(const Shapes& shapes, const Differences& differences, const CompareOptions& options, Comparison& out);

/// 95th percentile of the distances from points a step apart on each outline to the other; the greater of both ways.
/// NaN if one has no points.
double hausdorff_95(const std::vector<std::vector<Vec2>>& first, const std::vector<std::vector<Vec2>>& second,
                    double step);

}  // namespace pivnp::compare

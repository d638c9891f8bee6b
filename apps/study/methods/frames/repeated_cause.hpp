// What may cause an error that every pair of a sequence repeats, as far as frames and vectors can tell.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/core/record/closure_note.hpp"
#include "pivnp/core/record/vectors.hpp"

namespace pivnp::app {

/// Whether part of the picture stands still while the material moves: correlation coefficients of two frames at the same
/// pixels, in windows of 25 px about places amid texture that has moved on by more than its grains' size.
struct StillPicture {
  double correlation = 0, error = 0;  // mean, and its standard error
  int windows = 0;

  /// Enough windows, and more than chance leaves.
  bool seen() const { return windows >= 16 && correlation > 0.03 && correlation > 4 * error; }
};
StillPicture still_picture(const Image& first, const Image& second, const std::vector<Vec2>& places);

/// Pixels of the nodes about which all material within 48 px moves: a floor at rest is texture that stands still, too, and lies over nothing.
/// `moved_px`: of each node; no number where it is not known. Nodes that are not known do not count, unless they are the more.
std::vector<Vec2> amid_motion(const Setting& setting, int frame, const std::vector<double>& moved_px, double least_px);

/// Share of the repeated error's variance at nodes where the motion bends within a window (a second difference above a tenth
/// of a pixel a step), and the share of such nodes. `field`: of a pair of `steps` steps.
struct Bent {
  double variance = 0, nodes = 0;
  /// More than half of the error in less than a third of the nodes, or twice its share.
  bool seen() const { return variance > 0.5 && variance > 2 * nodes; }
};
Bent bent_share(const std::vector<std::array<float, 3>>& repeated, const VectorField& field, int steps, double pixel);

/// "a part of the picture stands still ..." or where the motion bends; empty: neither can be told.
std::string repeated_cause(const StillPicture& still, const Bent& bent);

}  // namespace pivnp::app

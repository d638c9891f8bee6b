// The plane-to-plane camera from targets.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::image {

struct Homography {
  Mat3 world_from_pixel;  // third coordinate positive at the targets; [2][2] is 1 unless that is on the other side
  double residual = 0;    // RMS distance in the world between targets and mapped pixels, length unit
};

/// Normalised direct linear transform (Hartley & Zisserman, Multiple View Geometry, 2nd ed., algorithm 4.2; here each
/// point set is whitened, so that a long narrow field of targets is no worse than a square one), then the least sum of
/// squared distances in the world by Gauss-Newton steps with Levenberg's damping.
/// Throws InputError: fewer than four pairs, lists of different length, a target given twice, no four targets of which
/// no three lie on a line, or targets in different order in the two lists (a horizon between them).
Homography fit_homography(const std::vector<Vec2>& pixel, const std::vector<Vec2>& world);

}  // namespace pivnp::image

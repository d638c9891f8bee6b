// The layer of material under a face, through which what acts on the face enters the sums over points.
#pragma once

#include <algorithm>

namespace pivnp::mpm {

/// f of the depth: 1 in the upper part, then 1 - 3 s^2 + 2 s^3, s from 0 to 1 at the layer's end.
struct FaceLayer {
  static constexpr double upper_cells = 1.5, cells = 4.5;  // where f begins to fall, and where it ends
  static constexpr double gap = 1.6;  // sides between a point and the next below: the material ends there

  double depth, upper = upper_cells / cells * depth;

  double fallen(double at) const { return std::clamp((at - upper) / (depth - upper), 0.0, 1.0); }  // s
  static double share(double s) { return 1 - s * s * (3 - 2 * s); }                                  // f
};

}  // namespace pivnp::mpm

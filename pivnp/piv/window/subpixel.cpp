#include "pivnp/piv/window/subpixel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pivnp::piv {

namespace {

bool gaussian_applies(float before, float middle, float after) {
  return middle > 0 && std::min(before, after) > 0.05f * middle;
}

}  // namespace

float three_point_peak(float before, float middle, float after) {
  if (!(middle >= before && middle >= after)) return 0;
  if (!gaussian_applies(before, middle, after)) {
    const float curvature = 2 * middle - before - after;
    return curvature > 0 ? 0.5f * (after - before) / curvature : 0.0f;
  }
  const float lb = std::log(before), lm = std::log(middle), la = std::log(after);
  const float curvature = 2 * lm - lb - la;
  return curvature > 0 ? 0.5f * (la - lb) / curvature : 0.0f;
}

float three_point_sensitivity(float before, float middle, float after) {
  float curvature = 2 * middle - before - after;
  if (gaussian_applies(before, middle, after))
    curvature = 0.5f * (before + after) * (2 * std::log(middle) - std::log(before) - std::log(after));
  return curvature > 0 ? 0.5f / curvature : std::numeric_limits<float>::infinity();
}

}  // namespace pivnp::piv

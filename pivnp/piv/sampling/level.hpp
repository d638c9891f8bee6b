// One resolution of a pair of frames.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/sampling/spline_image.hpp"

namespace pivnp::piv {

/// One resolution of a pair: pixel X of it is the mean of the full image's pixels D X ... D X + D - 1 (in each axis).
struct Level {
  int decimation = 1;
  SplineImage first, second;
  std::vector<std::uint8_t> mask;  // [height][width], 1 usable; empty: all are
  std::vector<std::uint8_t> first_mask;  // of the first frame, in place of `mask`; empty: `mask`

  float from_full(float x) const {
    return (x - 0.5f * static_cast<float>(decimation - 1)) / static_cast<float>(decimation);
  }
  float to_full(float x) const {
    return x * static_cast<float>(decimation) + 0.5f * static_cast<float>(decimation - 1);
  }
};

}  // namespace pivnp::piv

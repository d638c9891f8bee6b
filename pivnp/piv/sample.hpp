// Rows of pixels sampled at moved places, by the widest vectors there are.
#pragma once

#include "pivnp/piv/spline_image.hpp"

namespace pivnp::piv {

/// out[k] = image at (column + k + ux[k], row + uy[k]), k < count; places outside the image are moved to its edge. All
/// arrays hold `count` rounded up to a multiple of 16.
void sample_displaced(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                      float* out);

}  // namespace pivnp::piv

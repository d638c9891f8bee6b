// Rows of pixels sampled at moved places, by the widest vectors there are.
#pragma once

#include "pivnp/piv/sampling/spline_image.hpp"

namespace pivnp::piv {

/// out[k] = image at (column + k + ux[k], row + uy[k]), k < count; places outside the image are moved to its edge. All
/// arrays hold `count` rounded up to a multiple of 16.
void sample_displaced(const SplineImage& image, int column, int row, const float* ux, const float* uy, int count,
                      float* out);

/// Displacements of a frame along a row of pixels: ux = share du, uy = share dv. Clears use[k] where a place lies
/// beyond the image's edge by more than a hundredth of a pixel. Arrays as above.
void place_row(const SplineImage& image, int column, int row, const float* du, const float* dv, float share, int count,
               float* ux, float* uy, float* use);

}  // namespace pivnp::piv

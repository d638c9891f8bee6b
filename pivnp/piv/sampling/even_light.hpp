// Frames freed of light: of what changes the grey values of all grains about a pixel alike.
#pragma once

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// white/2 + white/6 (I - m)/s, with the mean m and the standard deviation s (at least white/100) of the grey values about the pixel, by
/// Gaussian weights of 2 px. The edge of a shadow is left as a line a grain wide, no higher than the grains are. Saturated pixels stay so.
Image even_light(const ImageView& frame, int threads);

/// Variance that rounding has in such a frame where s is least, for `rounding` in the frame as it was.
inline float evened_rounding(float rounding) { return rounding * (100.0f / 6.0f) * (100.0f / 6.0f); }

}  // namespace pivnp::piv

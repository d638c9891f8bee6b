// How much frames are smoothed before they are interpolated.
#pragma once

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// Weight a of the neighbours in (a, 1 - 2a, a) along each axis, 0 ... 1/4, from how alike adjacent pixels are. What a
/// texture holds near the shortest wavelength is partly aliased by sampling and moves the wrong way (bias with the
/// period of a pixel): grains of 3 px lose it with 0.17, finer ones with 1/4, coarse ones need none and match better
/// without, where grains are lost.
float presmoothing(const ImageView& first, const ImageView& second, int threads);

}  // namespace pivnp::piv

// How alike the noise of neighbouring pixels is in a case's frames.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/study/methods/frames/noise_shape.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

/// The noise of two frames between which `found` was measured at `nodes`, of those `used`: what is left of their difference once the
/// vectors (and their gradients, from neighbouring nodes) have taken the motion out, as a mean periodogram of blocks of 16 x 16
/// pixels about the nodes (Welch 1967), divided by what interpolation leaves of white noise there. White where fewer than 30 blocks
/// can be compared.
NoiseShape noise_shape(const Image& first, const Image& second, const piv::NodeLattice& nodes, const piv::PixelVectors& found,
                       const std::vector<std::uint8_t>& used);

}  // namespace pivnp::app

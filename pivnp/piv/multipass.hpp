// Method "fft": windows from large to small, frames deformed by what the larger ones found.
#pragma once

#include <memory>

#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

/// Sides of the windows in pixels of the full image, first to last. `first_window_px` = 0: four times the last window,
/// at least 128 px, at most half the image's shorter side.
std::vector<int> window_sides(const PivOptions& options, int width, int height);

std::unique_ptr<Method> make_multipass_fft(const PivOptions& options, const NodeLattice& nodes, int width, int height,
                                           int threads);

}  // namespace pivnp::piv

// Methods "fft" and "ncc": windows from large to small, frames deformed by what the larger ones found.
#pragma once

#include <memory>
#include <vector>

#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sampling/extent.hpp"

namespace pivnp::piv {

/// Side of the tapered window whose noise equals that of an even one of `window_px`: 1.2 times it. (The weight
/// W = 1 - (2x/L)^2 averages noise like an even window of (sum W)^2 / sum W^2 = 0.833 L an axis.)
int support_of_window(int window_px);

/// Sides of the windows in pixels of the full image, first to last. `first_window_px` = 0: four times the last window,
/// at least 128 px, at most half the image's shorter side.
std::vector<int> window_sides(const PivOptions& options, int width, int height);

/// "fft": every window size first searches all lags by FFT. "ncc": with the last window only the nearest lags are
/// correlated, directly, about what the larger windows found.
std::unique_ptr<Method> make_multipass(const PivOptions& options, const Extent& extent, int threads);

}  // namespace pivnp::piv

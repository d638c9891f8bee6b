// Methods "fft" and "ncc": windows from large to small, frames deformed by what the larger ones found.
#pragma once

#include <memory>

#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sampling/extent.hpp"
#include "pivnp/piv/window/correlate.hpp"

namespace pivnp::piv {

/// Every window size first searches all lags by FFT; the last one only where `last_window` says so ("fft"), else the
/// nearest lags alone are correlated with it, directly, about what the larger windows found ("ncc").
std::unique_ptr<Method> make_multipass(const PivOptions& options, const Extent& extent, int threads,
                                       Search last_window);

}  // namespace pivnp::piv

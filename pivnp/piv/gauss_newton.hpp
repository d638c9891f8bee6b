// Methods "gn" (the default) and "fast": Gauss-Newton on dense shared warps, from coarse images to fine.
#pragma once

#include <memory>

#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sampling/extent.hpp"

namespace pivnp::piv {

/// Every pass warps both frames once by the field found so far, sums the Gauss-Newton equations over hat-weighted cells
/// of a quarter of the window, corrects the field at the cells' corners and smooths it:
///   smoothing = "adaptive": every cell by itself, then shrinkage (Shrinker): the window is as large, and has the
///   shape, that noise and structure ask for; smoothing = "window": subsets of `window_px` of a fixed order, no
///   shrinkage.
/// `finest` 1: passes at 1/4, 1/2 and the full resolution; 2: ends at half of it.
/// Sources: docs/theory/piv.md, "Gauss-Newton on shared warps".
std::unique_ptr<Method> make_gauss_newton(const PivOptions& options, const Extent& extent, int threads, int finest);

}  // namespace pivnp::piv

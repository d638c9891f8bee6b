// Method "dis": OpenCV's dense inverse search, the quickest and the coarsest; validated like the others.
#pragma once

#include <memory>

#include "pivnp/piv/method.hpp"
#include "pivnp/piv/sampling/extent.hpp"

namespace pivnp::piv {

/// Decimation of the frames that the flow is found and validated on.
inline constexpr int dis_decimation = 2;

/// Dense inverse search (Kroeger et al. 2016) on frames of half the resolution, with `threads` of OpenCV's threads: its
/// coarsest useful setting (patches of 32 px of the full frame, no variational refinement), a quick look that errs by
/// tenths of a pixel. The flow belongs to the first frame; for the central anchor it is moved to the mid-point. One
/// warp and its sums then tell how well the frames match, and the field is not changed any more. Frames of more than 8
/// bits are scaled to 8.
std::unique_ptr<Method> make_dense_inverse_search(const PivOptions& options, const Extent& extent, int threads);

}  // namespace pivnp::piv

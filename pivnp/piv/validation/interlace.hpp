// Are frames interlaced: do their even and odd lines show two instants?
#pragma once

#include <array>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/record/vector_status.hpp"
#include "pivnp/piv/sampling/lattice.hpp"

namespace pivnp::piv {

/// By how many frames the odd lines of `frame` are later than its even ones: -.5, 0 or .5, the one of -.5, -.25, 0,
/// .25, .5 times the measured displacement of the material from frame to frame (px, `displacement` at the nodes) by
/// which the even lines, moved and interpolated, resemble the odd ones most, rounded to a half. 0 where the two do not
/// differ clearly (squared differences at 0 less than 1.2 times the least), or where fewer than 20 valid nodes move by
/// a pixel or more.
double field_delay(const ImageView& frame, const MaskView& mask, const NodeLattice& nodes,
                   const std::vector<std::array<float, 2>>& displacement, const std::vector<VectorStatus>& status);

}  // namespace pivnp::piv

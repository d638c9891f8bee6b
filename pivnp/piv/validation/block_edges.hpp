// Do the blocks of a strong compression (JPEG, video) show? They stand still while the material moves, and windows follow them.
#pragma once

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// Mean step of grey value across the edges of blocks of 8 px over that between other neighbouring pixels, both directions, wherever the
/// blocks begin (after Wang, Bovik & Evans 2000, Proc. ICIP 3:981): about 1 without compression, 1.0 to 1.6 on usual photographs,
/// 12 where nothing of a texture is left but blocks. 1 for an image of one grey; infinite where blocks are even.
double block_edge_ratio(const ImageView& image, const MaskView& mask);

/// Frames above this are warned of: at 3.3 half of the vectors are still right, at 12 windows begin to follow the blocks.
inline constexpr double most_block_edges = 5;

}  // namespace pivnp::piv

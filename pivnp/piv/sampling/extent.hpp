// What a method is made for: the part of the frames that a mask leaves, and the nodes in it.
#pragma once

#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/sampling/lattice.hpp"

namespace pivnp::piv {

struct Extent {
  NodeLattice nodes;  // pixels of the region
  MaskView mask;      // of the region; its data belong to the caller
  int width, height;  // of the region
};

/// The nodes, off where the mask excludes every pixel within `reach` (in column and row, rounded up to tiles of 16 px).
NodeLattice live_nodes(NodeLattice nodes, const MaskView& mask, float reach);

/// Box of the pixels that may be used, grown by `margin`, to sides of at least `least` and to multiples of 16 px (but
/// for the image's own edges): blocks of pixels that are averaged stay the same. The whole image without a mask.
Box usable_box(const MaskView& mask, int width, int height, int margin, int least);

ImageView part_of(const ImageView& image, const Box& box);
MaskView part_of(const MaskView& mask, const Box& box);

}  // namespace pivnp::piv

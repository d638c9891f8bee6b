// A frame as it is drawn under results: without the lens's bends. For pictures only; what is measured is never resampled.
#pragma once

#include "pivnp/image/camera/camera.hpp"
#include "pivnp/image/masks/mask.hpp"

namespace pivnp::image {

struct DrawnFrame {
  Image image;                // 8 bit where it had to be resampled, else the frame itself
  Mat3 world_from_pixel;      // of its pixels
};

/// `image` as `camera` sees it. Without a lens it is handed back with the camera's own matrix; with one it is resampled to
/// the ideal pixels that it covers, at most twice as wide and high as it was; what no pixel shows becomes black.
DrawnFrame drawn_frame(Image image, const Camera& camera);

/// A mask likewise (empty stays empty); what no pixel shows is usable.
Mask drawn_mask(const Mask& mask, const Camera& camera);

}  // namespace pivnp::image

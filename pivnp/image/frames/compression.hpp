// What a strong compression leaves in the grey values.
#pragma once

#include <filesystem>
#include <optional>

#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

/// The quality, 1 to 100, of the JPEG that an 8-bit image was, if its blocks of 8 x 8 pixels tell: their cosine
/// transforms then lie at multiples of the quantisation's steps (Fan & de Queiroz 2003, IEEE Trans. Image Process.
/// 12:230). The scale is that of libjpeg, by the standard's table for luminance (ITU-T T.81, K.1). Nothing above about
/// 90, where steps are lost among rounding, of images that were moved, scaled or filtered since, of those of which most
/// blocks hold black or white pixels, and of video.
std::optional<int> jpeg_quality(const ImageView& image);

/// The same of a JPEG file, by the first table of steps in its head; nothing of other files.
std::optional<int> jpeg_quality(const std::filesystem::path& file);

/// Frames below this are warned of.
inline constexpr int least_jpeg_quality = 70;

}  // namespace pivnp::image

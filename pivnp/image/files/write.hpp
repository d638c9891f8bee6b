// Images out.
#pragma once

#include <filesystem>

#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

/// Writes an 8- or 16-bit image; the suffix chooses the format (png, tif). Throws RunError naming the file.
void write_image(const ImageView& image, const std::filesystem::path& file);

/// What an 8-bit image is after it was kept as a JPEG of this quality, 1 to 100. Throws RunError where that fails.
Image through_jpeg(const ImageView& image, int quality);

}  // namespace pivnp::image

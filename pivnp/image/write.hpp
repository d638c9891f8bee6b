// Images out.
#pragma once

#include <filesystem>

#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

/// Writes an 8- or 16-bit image; the suffix chooses the format (png, tif). Throws RunError naming the file.
void write_image(const ImageView& image, const std::filesystem::path& file);

}  // namespace pivnp::image

// One image file in, one grey channel out.
#pragma once

#include <filesystem>
#include <string>

#include "pivnp/core/image_view.hpp"

namespace pivnp::image {

/// Grey values as stored (8 or 16 bit, floating point within 0..1), colour as ITU-R BT.601 luma, alpha ignored,
/// orientation tags not obeyed. Throws InputError "`what`: 'FILE' ..." if the file is missing, empty, truncated, of
/// several pages or not readable.
Image read_image_file(const std::filesystem::path& file, const std::string& what);

/// True if the file's first bytes are those of an image (not of a video).
bool looks_like_image(const std::filesystem::path& file);

/// "4096x3000 8-bit".
std::string describe(int width, int height, PixelDepth depth);

/// Keeps the image and video libraries from writing to standard error: what goes wrong is thrown, once.
void silence_vendor_messages();

}  // namespace pivnp::image

// Is an image file whole? Decoders tend to warn and to hand out a partly grey picture; the file's own structure tells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pivnp::image {

using Bytes = std::span<const unsigned char>;

enum class ImageFormat { unknown, png, jpeg, bmp, tiff, pnm };

/// By the first bytes, never by the name.
ImageFormat image_format(Bytes file);

/// What is wrong with the file ("truncated: ..."), or nothing. Formats without a check here pass.
///  png   every chunk inside the file with its CRC, up to IEND (ISO/IEC 15948)
///  jpeg  marker segments and scans up to EOI (ITU-T T.81 annex B); a damaged scan with all its markers passes
///  bmp   the pixel array lies inside the file
///  tiff  tags and pixels of the first page lie inside the file (TIFF 6.0, BigTIFF); more full-size pages are refused
///  webp  the length in its RIFF header
///  pnm   the raster of P2 to P6 lies inside the file
/// All of these: no more than 2^28 pixels.
std::optional<std::string> image_defect(Bytes file);

/// More pixels than a picture may have: a few bytes of a packed format ask for any amount of memory. Nothing, or "of 70000
/// x 60000 pixels, more than 268 million".
std::optional<std::string> too_many_pixels(std::uint64_t width, std::uint64_t height);

/// The part of image_defect() for TIFF.
std::optional<std::string> tiff_defect(Bytes file);
/// The first page's code of compression if it is none that every decoder knows (none, CCITT, LZW, JPEG, deflate,
/// PackBits), else 0: of such a file some decoders make black without a word.
int rare_tiff_compression(Bytes file);
/// Sets the orientation tag of the first page to "as stored", so that no decoder turns the picture.
void tiff_clear_orientation(std::span<unsigned char> file);

/// Leaves a whole PNG (image_defect() knows) without the chunks that are for viewers only (ISO/IEC 15948, 5.4: the type begins with a small
/// letter; transparency is kept): of those libpng prints what it thinks.
void png_drop_ancillary_chunks(std::vector<unsigned char>& file);

/// Full scale of a PGM or PPM file (its "maxval"), 0 if it has none.
int pnm_maxval(Bytes file);

}  // namespace pivnp::image

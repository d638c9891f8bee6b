#include "pivnp/image/files/image_check.hpp"

#include <array>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace pivnp::image {

namespace {

bool starts_with(Bytes file, std::string_view magic) {
  return file.size() >= magic.size() && std::memcmp(file.data(), magic.data(), magic.size()) == 0;
}

std::uint32_t big32(const unsigned char* p) {
  return std::uint32_t(p[0]) << 24 | std::uint32_t(p[1]) << 16 | std::uint32_t(p[2]) << 8 | p[3];
}

std::uint32_t little32(const unsigned char* p) {
  return std::uint32_t(p[3]) << 24 | std::uint32_t(p[2]) << 16 | std::uint32_t(p[1]) << 8 | p[0];
}

// CRC-32 of ISO 3309, as PNG uses it.
std::uint32_t crc32(Bytes data) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xEDB88320u ^ (c >> 1) : c >> 1;
      t[n] = c;
    }
    return t;
  }();
  std::uint32_t c = 0xFFFFFFFFu;
  for (const unsigned char byte : data) c = table[(c ^ byte) & 0xFF] ^ (c >> 8);
  return c ^ 0xFFFFFFFFu;
}

std::optional<std::string> png_defect(Bytes file) {
  if (file.size() >= 24)
    if (auto many = too_many_pixels(big32(&file[16]), big32(&file[20]))) return many;
  std::size_t at = 8;
  while (at + 12 <= file.size()) {
    const std::size_t length = big32(&file[at]);
    if (length > file.size() - at - 12) break;
    const Bytes checked = file.subspan(at + 4, 4 + length);  // type and data
    if (crc32(checked) != big32(&file[at + 8 + length])) return "damaged: a PNG chunk does not match its checksum";
    if (std::memcmp(checked.data(), "IEND", 4) == 0) return std::nullopt;
    at += 12 + length;
  }
  return "truncated: the PNG ends without its IEND chunk";
}

// End of the entropy-coded data that begins at `at`: the position of the next marker that is not a restart.
std::size_t jpeg_scan_end(Bytes file, std::size_t at) {
  while (at + 1 < file.size()) {
    const void* found = std::memchr(&file[at], 0xFF, file.size() - 1 - at);
    if (!found) break;
    at = std::size_t(static_cast<const unsigned char*>(found) - file.data());
    const unsigned char code = file[at + 1];
    if (code != 0x00 && code != 0xFF && !(code >= 0xD0 && code <= 0xD7)) return at;
    at += code == 0xFF ? 1 : 2;
  }
  return file.size();
}

std::optional<std::string> jpeg_defect(Bytes file) {
  constexpr unsigned char eoi = 0xD9, sos = 0xDA;
  bool scanned = false;
  std::size_t at = 2;
  while (at + 1 < file.size()) {
    if (file[at] != 0xFF) return "damaged: bytes that are no JPEG marker between two segments";
    const unsigned char code = file[at + 1];
    if (code == 0xFF) {  // fill byte
      ++at;
      continue;
    }
    if (code == eoi) {
      if (scanned) return std::nullopt;
      return "damaged: the JPEG holds no picture";
    }
    if (at + 3 >= file.size()) break;
    const std::size_t length = std::size_t(file[at + 2]) << 8 | file[at + 3];
    if (length < 2) return "damaged: a JPEG segment of impossible length";
    const bool frame = code >= 0xC0 && code <= 0xCF && code != 0xC4 && code != 0xC8 && code != 0xCC;
    if (frame && at + 8 < file.size())
      if (auto many = too_many_pixels(std::uint64_t(file[at + 7]) << 8 | file[at + 8], std::uint64_t(file[at + 5]) << 8 | file[at + 6]))
        return many;
    at += 2 + length;
    if (code == sos) {
      scanned = true;
      at = jpeg_scan_end(file, at);
    }
  }
  return "truncated: the JPEG ends without its end-of-image marker";
}

std::optional<std::string> bmp_defect(Bytes file) {
  if (file.size() < 26) return "truncated: the BMP ends within its header";
  const std::uint64_t offset = little32(&file[10]);
  const std::uint32_t header = little32(&file[14]);
  if (header < 40) return std::nullopt;  // OS/2 bitmaps: left to the decoder
  if (file.size() < 14 + std::size_t(header)) return "truncated: the BMP ends within its header";
  const std::uint64_t width = little32(&file[18]);
  const std::uint64_t height = std::uint64_t(std::abs(std::int64_t(std::int32_t(little32(&file[22])))));
  if (auto many = too_many_pixels(width, height)) return many;
  const std::uint64_t bits = std::uint64_t(file[28]) | std::uint64_t(file[29]) << 8;
  const std::uint32_t compression = little32(&file[30]);
  const bool plain = compression == 0 || compression == 3;
  const std::uint64_t pixels = plain ? (width * bits + 31) / 32 * 4 * height : little32(&file[34]);
  if (offset + pixels > file.size())
    return "truncated: the BMP has " + std::to_string(file.size()) + " bytes, its header asks for " +
           std::to_string(offset + pixels);
  return std::nullopt;
}

struct PnmHeader {
  int width = 0, height = 0, maxval = 0;
  std::size_t raster = 0;  // where the pixels begin; 0: the header is not complete
};

PnmHeader pnm_header(Bytes file) {
  const bool bitmap = file[1] == '1' || file[1] == '4';
  std::array<int, 3> number{0, 0, 1};
  std::size_t at = 2;
  for (int k = 0; k < (bitmap ? 2 : 3); ++k) {
    while (at < file.size() && (std::isspace(file[at]) || file[at] == '#')) {
      if (file[at] == '#')
        while (at < file.size() && file[at] != '\n') ++at;
      else
        ++at;
    }
    std::int64_t value = 0;
    const std::size_t begin = at;
    while (at < file.size() && std::isdigit(file[at]) && value < 100000000) value = value * 10 + (file[at++] - '0');
    if (at == begin || at >= file.size() || value >= 100000000) return {};
    number[std::size_t(k)] = int(value);
  }
  return {number[0], number[1], number[2], at + 1};
}

std::uint64_t count_words(Bytes text) {
  std::uint64_t words = 0;
  bool in_word = false;
  for (const unsigned char c : text) {
    words += !std::isspace(c) && !in_word;
    in_word = !std::isspace(c);
  }
  return words;
}

std::optional<std::string> pnm_defect(Bytes file) {
  const PnmHeader header = pnm_header(file);
  if (header.raster == 0) return "truncated: the PNM ends within its header";
  const std::uint64_t width = std::uint64_t(header.width), height = std::uint64_t(header.height);
  if (auto many = too_many_pixels(width, height)) return many;
  const std::uint64_t sample = header.maxval > 255 ? 2 : 1;
  const std::uint64_t numbers = width * height * (file[1] == '2' ? 1 : file[1] == '3' ? 3 : 0);
  if (numbers > 0 && count_words(file.subspan(header.raster)) < numbers)
    return "truncated: the PNM holds fewer than the " + std::to_string(numbers) + " numbers its header asks for";
  std::uint64_t raster = 0;  // the bitmap in ASCII, P1, is left to the decoder
  if (file[1] == '4') raster = (width + 7) / 8 * height;
  if (file[1] == '5') raster = width * height * sample;
  if (file[1] == '6') raster = 3 * width * height * sample;
  if (header.raster + raster > file.size())
    return "truncated: the PNM has " + std::to_string(file.size()) + " bytes, its header asks for " +
           std::to_string(header.raster + raster);
  return std::nullopt;
}

}  // namespace

std::optional<std::string> too_many_pixels(std::uint64_t width, std::uint64_t height) {
  constexpr std::uint64_t most = std::uint64_t{1} << 28;
  if (width == 0 || height <= most / width) return std::nullopt;
  return "of " + std::to_string(width) + " x " + std::to_string(height) + " pixels, more than 268 million";
}

ImageFormat image_format(Bytes file) {
  using namespace std::string_view_literals;
  if (starts_with(file, "\x89PNG\r\n\x1a\n"sv)) return ImageFormat::png;
  if (starts_with(file, "\xFF\xD8\xFF"sv)) return ImageFormat::jpeg;
  if (starts_with(file, "II*\0"sv) || starts_with(file, "MM\0*"sv)) return ImageFormat::tiff;
  if (starts_with(file, "II+\0"sv) || starts_with(file, "MM\0+"sv)) return ImageFormat::tiff;
  if (starts_with(file, "BM"sv)) return ImageFormat::bmp;
  const bool is_pnm = file.size() > 2 && file[0] == 'P' && file[1] >= '1' && file[1] <= '6';
  if (is_pnm && (std::isspace(file[2]) || file[2] == '#')) return ImageFormat::pnm;
  return ImageFormat::unknown;
}

std::optional<std::string> image_defect(Bytes file) {
  using namespace std::string_view_literals;
  if (file.empty()) return "empty: the file has 0 bytes";
  if (file.size() < 8) return "truncated: no image has as few as " + std::to_string(file.size()) + " bytes";
  switch (image_format(file)) {
    case ImageFormat::png: return png_defect(file);
    case ImageFormat::jpeg: return jpeg_defect(file);
    case ImageFormat::bmp: return bmp_defect(file);
    case ImageFormat::tiff: return tiff_defect(file);
    case ImageFormat::pnm: return pnm_defect(file);
    case ImageFormat::unknown: break;
  }
  if (starts_with(file, "RIFF"sv) && file.size() >= 12 && std::memcmp(file.data() + 8, "WEBP", 4) == 0) {
    const std::size_t length =
        8 + (file[4] | std::size_t(file[5]) << 8 | std::size_t(file[6]) << 16 | std::size_t(file[7]) << 24);
    if (length > file.size())
      return "truncated: the WebP has " + std::to_string(file.size()) + " bytes, its header asks for " +
             std::to_string(length);
  }
  return std::nullopt;
}

void png_drop_ancillary_chunks(std::vector<unsigned char>& file) {
  std::size_t at = 8, kept = 8;
  while (at + 12 <= file.size()) {
    const std::size_t length = 12 + big32(&file[at]);
    if (length > file.size() - at) break;
    const char* type = reinterpret_cast<const char*>(&file[at + 4]);
    const bool needed = (type[0] & 0x20) == 0 || std::memcmp(type, "tRNS", 4) == 0, last = std::memcmp(type, "IEND", 4) == 0;
    if (needed) {
      std::memmove(&file[kept], &file[at], length);
      kept += length;
    }
    if (last) break;
    at += length;
  }
  file.resize(kept);
}

int pnm_maxval(Bytes file) { return image_format(file) == ImageFormat::pnm ? pnm_header(file).maxval : 0; }

}  // namespace pivnp::image

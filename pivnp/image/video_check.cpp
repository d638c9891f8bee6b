// Whether a video file is whole, as far as its container says. A decoder takes what is there and stays silent.
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "pivnp/image/sources.hpp"

namespace pivnp::image {

namespace {

std::uint64_t big(const unsigned char* at, int bytes) {
  std::uint64_t value = 0;
  for (int k = 0; k < bytes; ++k) value = value << 8 | at[k];
  return value;
}

std::string beyond(const char* what, std::uint64_t end, std::uint64_t size) {
  return std::string("truncated: the ") + what + " has " + std::to_string(size) + " bytes, its header asks for " +
         std::to_string(end);
}

// MP4 and MOV are boxes one after the other, each with its size; the last may say "to the end" (0).
std::optional<std::string> boxes_defect(std::ifstream& in, std::uint64_t size) {
  for (std::uint64_t at = 0; at < size;) {
    unsigned char head[16] = {};
    in.clear();
    in.seekg(std::streamoff(at));
    in.read(reinterpret_cast<char*>(head), sizeof head);
    if (in.gcount() < 8) return beyond("video", at + 8, size);
    std::uint64_t length = big(head, 4);
    if (length == 0) return std::nullopt;
    if (length == 1) length = big(head + 8, 8);
    if (length < 8) return std::nullopt;  // no box: junk behind the last one
    if (length > size - at) return beyond("video", at + length, size);
    at += length;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> video_defect(const std::filesystem::path& file) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(file, failed);
  std::ifstream in(file, std::ios::binary);
  unsigned char head[12] = {};
  in.read(reinterpret_cast<char*>(head), sizeof head);
  if (failed || in.gcount() < std::streamsize(sizeof head)) return std::nullopt;
  const std::string_view begin(reinterpret_cast<const char*>(head), sizeof head);
  if (begin.substr(4, 4) == "ftyp" || begin.substr(4, 4) == "wide" || begin.substr(4, 4) == "mdat")
    return boxes_defect(in, size);
  if (begin.starts_with("RIFF")) {  // AVI, WebP; little-endian
    const std::uint64_t length = head[4] | head[5] << 8 | head[6] << 16 | std::uint64_t(head[7]) << 24;
    if (length + 8 > size) return beyond("file", length + 8, size);
  }
  if (begin.starts_with("GIF8")) {
    in.clear();
    in.seekg(-1, std::ios::end);
    if (in.get() != 0x3B) return "truncated: the GIF ends without its trailer";
  }
  return std::nullopt;
}

}  // namespace pivnp::image

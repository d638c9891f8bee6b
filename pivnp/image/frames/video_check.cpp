// Whether a video file is whole, as far as its container says. A decoder takes what is there and stays silent.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "pivnp/core/regular_file.hpp"
#include "pivnp/image/frames/sources.hpp"

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

// Bytes of the part of a program stream at `at` (ISO 13818-1, 2.5.3): a pack's head, or a packet by its stated length.
// 0: no part begins there. What lies beyond the text counts as zero.
std::size_t part_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return at + k < text.size() ? static_cast<unsigned char>(text[at + k]) : 0u; };
  const unsigned id = byte(3);
  if (byte(0) != 0 || byte(1) != 0 || byte(2) != 1 || id < 0xBA) return 0;
  if (id > 0xBA) return 6 + (byte(4) << 8 | byte(5));
  return (byte(4) & 0xC0) == 0x40 ? 14 + (byte(13) & 7) : 12;  // of MPEG-2, of MPEG-1
}

// MPEG program streams state the length of every packet, but not their own: only the last packet can tell. (That a stream
// ends without its end code means nothing, since most programs leave it out.)
std::optional<std::string> packets_defect(std::ifstream& in, std::uint64_t size) {
  constexpr std::uint64_t most = std::uint64_t{1} << 18;  // holds several packets of the greatest length
  const std::uint64_t first = size > most ? size - most : 0;
  std::string text(std::size_t(size - first), '\0');
  in.clear();
  in.seekg(std::streamoff(first));
  in.read(text.data(), std::streamsize(text.size()));
  const std::string_view pack("\0\0\x01\xBA", 4);
  for (std::size_t at = text.find(pack); at != text.npos; at = text.find(pack, at + 1)) {
    std::size_t end = at;
    while (end < text.size()) {
      const std::size_t length = part_length(text, end);
      if (length == 0) break;
      end += length;
    }
    if (end > text.size()) return beyond("video", first + end, size);
    const std::string_view rest = std::string_view(text).substr(end);
    if (rest.empty() || rest.starts_with(std::string_view("\0\0\x01\xB9", 4)) || rest.find_first_not_of('\0') == rest.npos)
      return std::nullopt;
    // Else what looked like a pack was none.
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> video_defect(const std::filesystem::path& file) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(file, failed);
  std::ifstream in = open_regular_file(file);
  unsigned char head[12] = {};
  in.read(reinterpret_cast<char*>(head), sizeof head);
  if (failed || in.gcount() < std::streamsize(sizeof head)) return std::nullopt;
  const std::string_view begin(reinterpret_cast<const char*>(head), sizeof head);
  if (begin.substr(4, 4) == "ftyp" || begin.substr(4, 4) == "wide" || begin.substr(4, 4) == "mdat")
    return boxes_defect(in, size);
  if (begin.starts_with(std::string_view("\0\0\x01\xBA", 4))) return packets_defect(in, size);
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

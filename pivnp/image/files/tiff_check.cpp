// The part of the TIFF 6.0 / BigTIFF structure that tells whether a file is whole and which way up it is stored.
#include <cstdint>
#include <vector>

#include "pivnp/image/files/image_check.hpp"

namespace pivnp::image {

namespace {

constexpr int tag_subfile_type = 254, tag_width = 256, tag_height = 257, tag_compression = 259, tag_strip_offsets = 273, tag_orientation = 274,
              tag_strip_bytes = 279, tag_tile_offsets = 324, tag_tile_bytes = 325;

struct Entry {
  int tag = 0, type = 0;
  std::uint64_t count = 0;
  std::size_t value_at = 0;  // position of the (first) value in the file
};

struct Page {
  bool whole = false;  // the directory itself lies inside the file
  std::vector<Entry> entries;
  std::uint64_t next = 0;  // position of the next directory, 0: none
};

// Bytes of one value; 0 for a type this file does not know.
std::size_t type_size(int type) {
  switch (type) {
    case 1: case 2: case 6: case 7: return 1;                       // BYTE, ASCII, SBYTE, UNDEFINED
    case 3: case 8: return 2;                                       // SHORT, SSHORT
    case 4: case 9: case 11: case 13: return 4;                     // LONG, SLONG, FLOAT, IFD
    case 5: case 10: case 12: case 16: case 17: case 18: return 8;  // (S)RATIONAL, DOUBLE, LONG8, SLONG8, IFD8
    default: return 0;
  }
}

bool is_unsigned_integer(int type) { return type == 3 || type == 4 || type == 13 || type == 16 || type == 18; }

class Reader {
 public:
  explicit Reader(Bytes file) : file_(file), little_(file[0] == 'I'), big_tiff_(file[little_ ? 2 : 3] == '+') {}

  std::uint64_t first_page() const { return big_tiff_ ? number(8, 8) : number(4, 4); }

  /// 0 beyond the end of the file.
  std::uint64_t number(std::uint64_t at, std::size_t bytes) const {
    if (at > file_.size() || bytes > file_.size() - at) return 0;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < bytes; ++k)
      value = value << 8 | file_[std::size_t(at) + (little_ ? bytes - 1 - k : k)];
    return value;
  }

  Page page(std::uint64_t at) const {
    Page page;
    const std::size_t count_size = big_tiff_ ? 8 : 2, entry_size = big_tiff_ ? 20 : 12, word = big_tiff_ ? 8 : 4;
    const std::uint64_t count = number(at, count_size);
    if (at == 0 || at >= file_.size() || count == 0 || count > (file_.size() - at) / entry_size) return page;
    const std::uint64_t end = at + count_size + count * entry_size;
    if (end + word > file_.size()) return page;
    page.whole = true;
    page.next = number(end, word);
    for (std::uint64_t k = 0; k < count; ++k) {
      const std::uint64_t entry = at + count_size + k * entry_size;
      Entry e{int(number(entry, 2)), int(number(entry + 2, 2)), number(entry + 4, word), 0};
      const std::size_t size = type_size(e.type);
      const std::uint64_t value = entry + 4 + word;
      const bool is_inside = size > 0 && e.count <= word / size;
      e.value_at = std::size_t(is_inside ? value : number(value, word));
      page.entries.push_back(e);
    }
    return page;
  }

  bool inside(const Entry& e) const {
    const std::size_t size = type_size(e.type);
    return size == 0 || (e.value_at <= file_.size() && e.count <= (file_.size() - e.value_at) / size);
  }

  /// The values of a tag of whole numbers; none if it is missing or lies beyond the end.
  std::vector<std::uint64_t> values(const Page& page, int tag) const {
    std::vector<std::uint64_t> out;
    for (const Entry& e : page.entries) {
      if (e.tag != tag || !is_unsigned_integer(e.type) || !inside(e)) continue;
      for (std::uint64_t k = 0; k < e.count; ++k)
        out.push_back(number(e.value_at + k * type_size(e.type), type_size(e.type)));
    }
    return out;
  }

 private:
  Bytes file_;
  bool little_, big_tiff_;
};

// True if every strip (or tile) lies inside the file.
bool data_inside(const Reader& reader, const Page& page, std::size_t file_size, int offsets_tag, int bytes_tag) {
  const std::vector<std::uint64_t> offsets = reader.values(page, offsets_tag);
  const std::vector<std::uint64_t> bytes = reader.values(page, bytes_tag);
  for (std::size_t k = 0; k < offsets.size(); ++k) {
    const std::uint64_t length = k < bytes.size() ? bytes[k] : 0;
    if (offsets[k] > file_size || length > file_size - offsets[k]) return false;
  }
  return true;
}

}  // namespace

std::optional<std::string> tiff_defect(Bytes file) {
  if (file.size() < 16) return "truncated: the TIFF ends within its header";
  const Reader reader(file);
  const Page first = reader.page(reader.first_page());
  if (!first.whole) return "truncated: the TIFF's directory lies beyond its end";
  for (const Entry& e : first.entries)
    if (!reader.inside(e)) return "truncated: the TIFF's tag " + std::to_string(e.tag) + " lies beyond its end";
  if (!data_inside(reader, first, file.size(), tag_strip_offsets, tag_strip_bytes) ||
      !data_inside(reader, first, file.size(), tag_tile_offsets, tag_tile_bytes))
    return "truncated: the TIFF's pixels lie beyond its end";
  const std::vector<std::uint64_t> width = reader.values(first, tag_width), height = reader.values(first, tag_height);
  if (!width.empty() && !height.empty())
    if (auto many = too_many_pixels(width[0], height[0])) return many;

  // A second page that is no preview is a frame that would be lost without a word.
  std::uint64_t at = first.next;
  for (int pages = 0; at != 0 && pages < 1000; ++pages) {
    const Page page = reader.page(at);
    if (!page.whole) return "truncated: a TIFF directory lies beyond the file's end";
    const std::vector<std::uint64_t> kind = reader.values(page, tag_subfile_type);
    if (kind.empty() || (kind[0] & 5) == 0)  // neither a reduced image nor a transparency mask
      return "a TIFF of several pages; write one frame a file";
    at = page.next;
  }
  return std::nullopt;
}

int rare_tiff_compression(Bytes file) {
  if (file.size() < 16) return 0;
  const Reader reader(file);
  const std::vector<std::uint64_t> code = reader.values(reader.page(reader.first_page()), tag_compression);
  if (code.empty()) return 0;
  for (const std::uint64_t known : {1, 2, 3, 4, 5, 7, 8, 32773, 32946})
    if (code[0] == known) return 0;
  return int(code[0]);
}

void tiff_clear_orientation(std::span<unsigned char> file) {
  if (file.size() < 16) return;
  const Reader reader(file);
  for (const Entry& e : reader.page(reader.first_page()).entries)
    if (e.tag == tag_orientation && e.type == 3 && e.value_at + 2 <= file.size()) {
      file[e.value_at] = file[0] == 'I' ? 1 : 0;
      file[e.value_at + 1] = file[0] == 'I' ? 0 : 1;
    }
}

}  // namespace pivnp::image

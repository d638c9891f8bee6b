#include "pivnp/piv/sampling/extent.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pivnp::piv {

namespace {

constexpr int tile = 16;

}  // namespace

NodeLattice live_nodes(NodeLattice nodes, const MaskView& mask, float reach) {
  if (mask.data == nullptr) return nodes;
  const int columns = (mask.width + tile - 1) / tile, rows = (mask.height + tile - 1) / tile;
  std::vector<std::uint8_t> tiles(std::size_t(columns) * std::size_t(rows), 0);  // 1: holds a usable pixel
  for (int r = 0; r < mask.height; ++r)
    for (int c = 0; c < mask.width; c += tile) {
      std::uint8_t& some = tiles[std::size_t(r / tile) * std::size_t(columns) + std::size_t(c / tile)];
      for (int k = c; !some && k < std::min(c + tile, mask.width); ++k) some = mask.usable(k, r);
    }
  std::vector<std::uint8_t> on(nodes.pixel.size(), 0);
  const auto first = [&](float at) { return std::max(0, static_cast<int>(std::floor(at - reach)) / tile); };
  const auto last = [&](float at, int count) {
    return std::min(static_cast<int>(std::floor(at + reach)) / tile, count - 1);
  };
  for (std::size_t k = 0; k < on.size(); ++k) {
    const auto [x, y] = nodes.pixel[k];
    if (!switched_on(nodes, k) || !(std::abs(x) < 1e6f && std::abs(y) < 1e6f)) continue;
    for (int j = first(y); j <= last(y, rows) && !on[k]; ++j)
      for (int i = first(x); i <= last(x, columns) && !on[k]; ++i)
        on[k] = tiles[std::size_t(j) * std::size_t(columns) + std::size_t(i)];
  }
  nodes.on = std::move(on);
  return nodes;
}

Box usable_box(const MaskView& mask, int width, int height, int margin, int least) {
  if (mask.data == nullptr) return {0, 0, width, height};
  Box box{width, height, 0, 0};
  for (int r = 0; r < height; ++r) {
    int first = 0, end = width;
    while (first < end && !mask.usable(first, r)) ++first;
    while (first < end && !mask.usable(end - 1, r)) --end;
    if (first == end) continue;
    box.x0 = std::min(box.x0, first), box.x1 = std::max(box.x1, end);
    box.y0 = std::min(box.y0, r), box.y1 = r + 1;
  }
  const auto grow = [&](int& from, int& to, int size) {
    if (to <= from) from = to = size / 2;
    from = std::max(0, from - margin), to = std::min(size, to + margin);
    if (const int lacking = least - (to - from); lacking > 0) {
      from = std::clamp(from - lacking / 2, 0, std::max(0, size - least));
      to = std::min(size, from + least);
    }
    from = from / tile * tile, to = std::min((to + tile - 1) / tile * tile, size);
  };
  grow(box.x0, box.x1, width);
  grow(box.y0, box.y1, height);
  return box;
}

ImageView part_of(const ImageView& image, const Box& box) {
  ImageView part = image;
  const int bytes = image.depth == PixelDepth::u8 ? 1 : image.depth == PixelDepth::u16 ? 2 : 4;
  part.data += std::ptrdiff_t(box.y0) * image.stride + std::ptrdiff_t(box.x0) * bytes;
  part.width = box.width(), part.height = box.height();
  return part;
}

MaskView part_of(const MaskView& mask, const Box& box) {
  if (mask.data == nullptr) return {};
  return {mask.data + std::ptrdiff_t(box.y0) * mask.stride + box.x0, box.width(), box.height(), mask.stride};
}

}  // namespace pivnp::piv

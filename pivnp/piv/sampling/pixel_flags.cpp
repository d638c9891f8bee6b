#include "pivnp/piv/sampling/pixel_flags.hpp"

#include <algorithm>
#include <utility>

namespace pivnp::piv {

namespace {

template <class Grey>
void find_saturated(const ImageView& image, std::vector<std::pair<int, int>>& places) {
  const Grey white = static_cast<Grey>(image.white);
  for (int r = 0; r < image.height; ++r) {
    const Grey* row = image.row<Grey>(r);
    for (int c = 0; c < image.width;) {
      constexpr int run = 64;  // most runs hold none: one test for all of them
      const int end = std::min(c + run, image.width);
      unsigned some = 0;
      for (int k = c; k < end; ++k) some |= row[k] >= white;
      for (int k = c; some && k < end; ++k)
        if (row[k] >= white) places.emplace_back(k, r);
      c = end;
    }
  }
}

}  // namespace

void PixelFlags::resize(int width, int height) {
  width_ = width, height_ = height, tiles_ = (width + tile - 1) / tile;
  flag_.assign(std::size_t(width) * std::size_t(height), 0);
  tile_flag_.assign(std::size_t(tiles_) * std::size_t((height + tile - 1) / tile), 0);
}

void PixelFlags::take(const ImageView& image, const PixelFlags& masked) {
  std::vector<std::pair<int, int>> saturated;
  if (image.depth == PixelDepth::u8)
    find_saturated<std::uint8_t>(image, saturated);
  else if (image.depth == PixelDepth::u16)
    find_saturated<std::uint16_t>(image, saturated);
  else
    find_saturated<float>(image, saturated);
  if (static_cast<double>(saturated.size()) > most_saturated * image.width * image.height) saturated.clear();
  any_ = masked.any_;
  if (saturated.empty() && !any_) return;
  if (any_)
    *this = masked;
  else
    resize(image.width, image.height);
  for (const auto& [c, r] : saturated) mark(c, r, 1);
  widen_tiles();
}

void PixelFlags::take_mask(const MaskView& mask, int decimation, bool strict) {
  any_ = false;
  if (mask.data == nullptr) return;
  resize(mask.width / decimation, mask.height / decimation);
  const int more = strict && decimation > 1 ? 1 : 0;
  for (int r = 0; r < height_; ++r)
    for (int c = 0; c < width_; ++c) {
      int excluded = 0;
      for (int b = -more; b < decimation + more; ++b)
        for (int a = -more; a < decimation + more; ++a)
          excluded += !mask.usable(std::clamp(c * decimation + a, 0, mask.width - 1), std::clamp(r * decimation + b, 0, mask.height - 1));
      if (excluded > (strict ? 0 : decimation * decimation / 2)) mark(c, r, 0);
    }
  widen_tiles();
}

void PixelFlags::widen_tiles() {
  const int rows = static_cast<int>(tile_flag_.size()) / tiles_;
  around_.assign(tile_flag_.size(), 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < tiles_; ++c) {
      if (!tile_flag_[std::size_t(r) * std::size_t(tiles_) + std::size_t(c)]) continue;
      for (int b = std::max(0, r - 1); b <= std::min(rows - 1, r + 1); ++b)
        for (int a = std::max(0, c - 1); a <= std::min(tiles_ - 1, c + 1); ++a)
          around_[std::size_t(b) * std::size_t(tiles_) + std::size_t(a)] = 1;
    }
}

void PixelFlags::mark(int column, int row, int reach) {
  any_ = true;
  for (int r = std::max(0, row - reach); r <= std::min(height_ - 1, row + reach); ++r)
    for (int c = std::max(0, column - reach); c <= std::min(width_ - 1, column + reach); ++c) {
      flag_[std::size_t(r) * std::size_t(width_) + std::size_t(c)] = 1;
      tile_flag_[std::size_t(r / tile) * std::size_t(tiles_) + std::size_t(c / tile)] = 1;
    }
}

bool PixelFlags::any_in(int column0, int row0, int column1, int row1) const {
  const int c0 = std::clamp(column0, 0, width_ - 1) / tile, c1 = std::clamp(column1, 0, width_ - 1) / tile;
  const int r0 = std::clamp(row0, 0, height_ - 1) / tile, r1 = std::clamp(row1, 0, height_ - 1) / tile;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c)
      if (tile_flag_[std::size_t(r) * std::size_t(tiles_) + std::size_t(c)]) return true;
  return false;
}

}  // namespace pivnp::piv

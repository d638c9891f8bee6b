// Pixels of a frame that must not be used.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// Flags of masked pixels and of saturated ones with their neighbours (a clipped grain has lost its shape). Tiles tell
/// at once where nothing is flagged.
class PixelFlags {
 public:
  /// Flags the pixels of an image averaged over blocks of `decimation` of whose block the mask excludes more than half;
  /// `strict`: any pixel of the block or next to it, where what is excluded is in the averages.
  void take_mask(const MaskView& mask, int decimation, bool strict = false);

  /// The flags of `masked` and, unless that were more than `most_saturated` of all pixels, those of what is saturated.
  void take(const ImageView& image, const PixelFlags& masked);

  bool empty() const { return !any_; }
  bool at(int column, int row) const {
    return flag_[std::size_t(row) * std::size_t(width_) + std::size_t(column)] != 0;
  }
  /// False if no pixel of the tiles that cover the box is flagged; the box may reach beyond the image.
  bool any(int column0, int row0, int column1, int row1) const {
    // A box no wider than two tiles lies in the nine about its middle.
    const int c = std::clamp((column0 + column1) >> 1, 0, width_ - 1),
              r = std::clamp((row0 + row1) >> 1, 0, height_ - 1);
    if (column1 - column0 <= 2 * tile && row1 - row0 <= 2 * tile &&
        !around_[std::size_t(r / tile) * std::size_t(tiles_) + std::size_t(c / tile)])
      return false;
    return any_in(column0, row0, column1, row1);
  }

 private:
  static constexpr int tile = 16;
  static constexpr double most_saturated = 0.05;  // of the pixels, before their neighbours are counted: beyond it
                                                  // clipping is part of the texture, and what is left would not suffice
  void resize(int width, int height);
  bool any_in(int column0, int row0, int column1, int row1) const;
  void mark(int column, int row, int reach);
  void widen_tiles();

  int width_ = 0, height_ = 0, tiles_ = 0;
  bool any_ = false;
  std::vector<std::uint8_t> flag_, tile_flag_;
  std::vector<std::uint8_t> around_;  // of tiles: one of the nine about it is flagged
};

}  // namespace pivnp::piv

// Pixels of a frame that must not be used.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/image_view.hpp"

namespace pivnp::piv {

/// Flags of masked pixels and of saturated ones with their neighbours (a clipped grain has lost its shape). Tiles tell
/// at once where nothing is flagged.
class PixelFlags {
 public:
  /// Flags what the mask excludes and, unless that were more than `most_saturated` of all pixels, what is saturated.
  void take(const ImageView& image, const MaskView& mask);

  /// Flags the pixels of an image averaged over blocks of `decimation` of whose block the mask excludes more than half.
  void take_mask(const MaskView& mask, int decimation);

  bool empty() const { return !any_; }
  bool at(int column, int row) const {
    return flag_[std::size_t(row) * std::size_t(width_) + std::size_t(column)] != 0;
  }
  /// False if no pixel of the tiles that cover the box is flagged; the box may reach beyond the image.
  bool any(int column0, int row0, int column1, int row1) const;

 private:
  static constexpr int tile = 16;
  static constexpr double most_saturated = 0.05;  // of the pixels, before their neighbours are counted: beyond it
                                                  // clipping is part of the texture, and what is left would not suffice
  void resize(int width, int height);
  void mark(int column, int row, int reach);

  int width_ = 0, height_ = 0, tiles_ = 0;
  bool any_ = false;
  std::vector<std::uint8_t> flag_, tile_flag_;
};

}  // namespace pivnp::piv

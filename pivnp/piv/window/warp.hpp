// Both frames of a pair, brought onto each other by the predictor.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/record/vector_status.hpp"
#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/sampling/level.hpp"
#include "pivnp/piv/window/predictor.hpp"

namespace pivnp::piv {

/// Warped frames over a box of a level's pixels: f(x) and g(x) show the same material where the predictor is right.
struct WarpedPair {
  static constexpr int padding = 512;  // before the first pixel and behind the last: windows read beyond the box's rows
  Box box;
  std::ptrdiff_t stride = 0;
  std::vector<float> f, g;    // rows of the box, `stride` apart, padded
  std::vector<float> use;     // 1; 0 where masked or where the place in either frame is beyond the image's edge
  std::vector<float> masked;  // 1 where masked; empty without a mask
  std::size_t index(int column, int row) const {
    return std::size_t(row - box.y0) * std::size_t(stride) + std::size_t(column - box.x0) + padding;
  }
  void resize(const Box& to, bool with_mask);

  static constexpr int tile = 32;
  std::vector<std::uint8_t> partial;  // [tile rows][tile columns] of the box: some pixel of the tile has use 0
  int tiles_across() const { return (box.width() + tile - 1) / tile; }
  /// True if every pixel of a part of the box may be used, for certain.
  bool whole(int column0, int row0, int column1, int row1) const {
    const int c1 = (column1 - 1 - box.x0) / tile, r1 = (row1 - 1 - box.y0) / tile;
    for (int r = (row0 - box.y0) / tile; r <= r1; ++r)
      for (int c = (column0 - box.x0) / tile; c <= c1; ++c)
        if (partial[std::size_t(r) * std::size_t(tiles_across()) + std::size_t(c)]) return false;
    return true;
  }
  /// Fills `partial`, all of it set before, from `use`.
  void mark_tiles(int threads);
};

/// f(x) = first(x - d/2), g(x) = second(x + d/2) for the central anchor; f(x) = first(x), g(x) = second(x + d) for the
/// forward one; d is the predictor at x. A pixel is masked if any of the four pixels about its place in either frame
/// is.
void warp_pair(const Level& level, const PredictorField& predictor, Anchor anchor, const Box& box, int threads,
               WarpedPair& warped);

}  // namespace pivnp::piv

// Pictures made without Qt: particles as deformed squares, and a frame as the camera sees the world.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "apps/plot/palette.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::plot {

/// A rectangle of the world.
struct Box {
  Vec2 lower = Vec2::Zero(), upper = Vec2::Zero();
  double width() const { return upper.x() - lower.x(); }
  double height() const { return upper.y() - lower.y(); }
};

/// 0xAARRGGBB (not premultiplied), rows downward: row 0 is the top of the box.
struct Raster {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

/// Where a particle is and what it looks like. `half_x`, `half_y`: half edges of its deformed square.
struct Tile {
  Vec2 centre, half_x, half_y;
  Rgb colour;
};

/// Draws the tiles in their order into a raster that covers `box`, `width` pixels wide, edges smoothed by 2 x 2
/// samples. Where no tile is, alpha is 0. A tile is at least one sample large, so that none is lost.
Raster draw_tiles(std::span<const Tile> tiles, const Box& box, int width);

/// The world box that the whole image covers.
Box image_box(int width, int height, const Mat3& world_from_pixel);

/// The frame over `box`, `width` pixels wide, resampled through the camera; grey values between the 1st and the 99th
/// percentile are spread over `dark` .. `light`. Outside the image alpha is 0.
Raster draw_image(const ImageView& image, const Mat3& world_from_pixel, const Box& box, int width, int dark, int light);

}  // namespace pivnp::plot

// What a case means on its first frame: grid, masks, regions, boundaries and a scale bar, before anything is run.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::report {

/// A line drawn over the frame, world coordinates.
struct Outline {
  enum class Kind { region, boundary, body };
  Kind kind = Kind::region;
  std::string name;
  std::vector<Vec2> points;
  bool closed = true;
};

struct CheckInput {
  ImageView image;  // no data: an empty background (a case without frames)
  MaskView mask;
  Mat3 world_from_pixel = Mat3::Identity();
  // Where the frame's own pixels are in the world, and their number, if a lens bends them; left out: as the image's.
  std::function<Vec2(const Vec2& pixel)> to_world = {};
  int columns = 0, rows = 0;
  std::string length_unit;
  Grid grid;
  std::vector<Outline> outlines;
};

/// Writes one PNG at print resolution. Throws RunError naming the file.
void write_check(const CheckInput& input, const std::filesystem::path& file);

}  // namespace pivnp::report

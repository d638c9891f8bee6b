// The outline of a region that moves with its material.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::app {

/// What lies outside a region beside a point of its outline, as far as frames have shown it.
enum class Outside : std::uint8_t { unknown, still, moving };

/// What is left out.
inline bool left_out(Outside outside) { return outside == Outside::still; }

struct OutlinePoint {
  Vec2 place = {0, 0};        // in the world, in the frame at hand
  Vec2 moved = {0, 0};        // in the last pair
  Outside outside = Outside::unknown;
  bool carried = true;        // by vectors beside it; else by its neighbours on the outline
};

struct MovingOutline {
  std::string name;
  std::vector<OutlinePoint> points;  // 2 to 6 px apart, the last joined to the first
};

}  // namespace pivnp::app

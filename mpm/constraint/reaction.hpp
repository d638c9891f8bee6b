// What walls and bodies do to nodes.
#pragma once

#include <cstdint>

namespace pivnp::mpm {

/// Of a wall or body in a step: impulse on the material (N s/m) and the wall's own velocity.
struct Reaction {
  std::uint32_t node;
  double impulse_x, impulse_y;
  double wall_x, wall_y;
  int body = -1;  // index of the rigid body; -1: a wall
};

}  // namespace pivnp::mpm

// What walls and bodies do to nodes.
#pragma once

#include <cstdint>

#include "pivnp/core/math.hpp"

namespace pivnp::mpm {

/// What a boundary or body has done to the material since time 0.
struct Impulse {
  double x = 0, y = 0;  // N s/m
  double moment = 0;    // about the origin of coordinates, N s

  void add(const Vec2& impulse, const Vec2& at) {
    x += impulse.x();
    y += impulse.y();
    moment += at.x() * impulse.y() - at.y() * impulse.x();
  }
};

/// A node with next to no mass, and those that it moves with: by 2 v(heavy) - v(beyond), or with `heavy` where that is both.
struct JoinedNode {
  std::uint32_t small, heavy, beyond;
};

/// Of a wall or body in a step: impulse on the material (N s/m) and the wall's own velocity.
struct Reaction {
  std::uint32_t node;
  double impulse_x, impulse_y;
  double wall_x, wall_y;
  int body = -1;  // index of the rigid body; -1: a wall
};

}  // namespace pivnp::mpm

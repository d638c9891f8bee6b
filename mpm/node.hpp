// What a node of the grid carries during a step.
#pragma once

namespace pivnp::mpm {

/// Kept in the order in which the kernels add to it: four at once, then two and two (lanes.hpp).
struct alignas(32) Node {
  double mass = 0;          // kg/m
  double vx = 0, vy = 0;    // velocity mapped from the points, m/s (while it is being mapped: momentum)
  double fx = 0, fy = 0;    // force on the node, N/m
  bool held = false;        // by a wall or body
  double ux = 0, uy = 0;    // velocity that strains the material (MUSL: mapped again), restrained
  double nx = 0, ny = 0;    // velocity after the momentum update and the restraints
  double dx = 0, dy = 0;    // damping force, part of the force, N/m; between uses: averages (strain.cpp)
};
static_assert(sizeof(Node) == 96);

}  // namespace pivnp::mpm

// What the kernels see of particles and grid: plain pointers, no Eigen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/state/node.hpp"

namespace pivnp::mpm {

struct MovedNodes;

/// The arrays of Particles; those that a case does not need are null.
struct PointView {
  double *x, *y, *vx, *vy, *mass, *volume0;
  double *F_xx, *F_xy, *F_yx, *F_yy, *J;
  double *tau_xx, *tau_yy, *tau_zz, *tau_xy;
  double *C_xx, *C_xy, *C_yx, *C_yy;
  double* half;
  double *xi, *eta;  // null where no scheme asks for them (Where)
  double* opening;  // null where no law opens
  double *F_zz, *hoop;  // null but in axisymmetric runs: radius over that at the start; log hoop strain of the step
  double* pressure;  // of the pores; null without water
  double* displacing;  // what opens displaces water outside: 1, or 0 in drained pores; null where all does
  double density;  // where `mass` is null
  double outside, level;  // weight of the water outside, N/m^3 (0: none), and the height of its surface
};

/// The lists of GridState.
struct CellView {
  const std::uint32_t *order, *begin;  // points, cell after cell; of each occupied cell, its first one's place
  const std::int32_t* index;           // of each occupied cell
  const std::uint8_t* marks;           // likewise: WallSide, strained_apart, at_edge, wall_moved
  const MovedNodes* moved;             // of every cell of the grid, where one is marked wall_moved
  std::size_t points;                  // of which `order` is made
  Node* node;
  double* strain_velocity;  // x, y of the velocity that gives the strain increments; of the next node `to_next` behind
  std::ptrdiff_t to_next;
  const double* own_strain_velocity;  // the same, side by side, where a cell is strained apart
  AverageView average;
  int nx, ny;      // nodes in a row, and rows of a velocity field that count
  int field_rows;  // from one velocity field to the next
  int origin;      // of a cell, from its lower left node, in nodes
  double hx, hy, per_hx, per_hy, origin_x, origin_y;  // origin: of the nodes
};

/// Of a list: from `begin` to before `end`.
struct Range {
  std::size_t begin = 0, end = 0;
};

}  // namespace pivnp::mpm

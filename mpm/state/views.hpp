// What the kernels see of particles and grid: plain pointers, no Eigen.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/state/node.hpp"

namespace pivnp::mpm {

/// The arrays of Particles; those that a case does not need are null.
struct PointView {
  double *x, *y, *vx, *vy, *mass, *volume0;
  double *F_xx, *F_xy, *F_yx, *F_yy, *J;
  double *tau_xx, *tau_yy, *tau_zz, *tau_xy;
  double *C_xx, *C_xy, *C_yx, *C_yy;
  double* half;
  double *xi, *eta;  // null where no scheme asks for them (Where)
  double* opening;  // null where no law opens
  double density;  // where `mass` is null
};

/// The lists of GridState.
struct CellView {
  const std::uint32_t *order, *slot_begin;
  const std::int32_t* slot_cell;
  const std::uint8_t* slot_marks;  // Fold, strained_apart, at_edge
  std::size_t points;  // of which `order` is made
  Node* node;
  double* straining;  // x, y of the velocity that strains the material; of the next node `to_next` behind
  std::ptrdiff_t to_next;
  const double* apart;  // the same, side by side, where a slot is strained apart
  AverageView average;
  int nx, ny;      // nodes in a row, and rows of a sheet that count
  int sheet_rows;  // from one sheet to the next
  int origin;      // of a cell, from its lower left node, in nodes
  double hx, hy, per_hx, per_hy, origin_x, origin_y;  // origin: of the nodes
};

struct SlotRange {
  std::size_t begin = 0, end = 0;
};

}  // namespace pivnp::mpm

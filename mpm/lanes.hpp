// The kernels of a step: loops over the points of cells, as many points at a time as the processor has lanes. Compiled
// once for each instruction set and chosen at run time (Highway); nothing here may include Eigen.
//
// A tile is as many points as there are lanes, four or eight, in groups of four, each of one cell. Where a tile's points
// lie together in storage (after a re-sort, nearly all) a field is one load, where a group's do, one a group; otherwise it
// is put together point by point. Lanes beyond a cell's last point have no mass and no volume, and are not stored. Sums
// over a group's lanes are formed in one order, and added to the nodes group after group: so the bits depend on the
// order of the cells, the points in them and in storage, and the lanes (their sums' order; tiles choose their series together).
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/node.hpp"
#include "mpm/scheme.hpp"

namespace pivnp::mpm {

/// The arrays of Particles; those that a scheme does not use are null.
struct PointView {
  double *x, *y, *vx, *vy, *mass, *volume0;
  double *F_xx, *F_xy, *F_yx, *F_yy, *J;
  double *tau_xx, *tau_yy, *tau_zz, *tau_xy;
  double *C_xx, *C_xy, *C_yx, *C_yy;
  double* half;
  double *xi, *eta;  // null where no scheme asks for them (Where)
  double* gap;
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

/// What a gather of velocity saw.
struct GatherSums {
  double fastest2 = 0;      // largest squared speed of a point, m^2/s^2
  double kinetic_loss = 0;  // kinetic energy of the points before less after, J/m
  bool good = true;         // every point finite, none moved more than one cell
  std::size_t suspects = 0;  // points that are not in their cell any more, where the sweep looked
};

/// From where points are strained: where they are; where they were before they moved, which is by dt v (usl with apic), or
/// at natural coordinates that were kept then.
enum class Where { now, before, kept };

/// Increments of a run of points (material/material.hpp), in the order in which the cells list them; room for a tile more.
struct Increments {
  double *xx, *yy, *zz, *xy, *spin;
};

struct StrainJob {
  Locking locking;
  double dt;
  bool record;  // F and J too
  Where where = Where::now;
};

struct MoveJob {
  double dt, pic;          // share of PIC (flip)
  double reach2;           // greatest squared speed that is good
  const double* filtered;  // xpic: x, y of every node
  TransferKind transfer;
  bool remap;              // musl
  bool keep;               // natural coordinates, for Where::kept
};

/// Places in `order` of the points that are not in their cell, to `suspects`, whose number is returned.
std::size_t locate_lanes(const PointView& p, const CellView& c, SlotRange slots, std::uint32_t* suspects);
/// Adds mass, momentum and internal force to Node::mass, vx, vy, fx, fy. F-bar of three-node shapes: with the
/// average of the mean stress.
void map_lanes(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, SlotRange slots);
/// Adds V0 times the mean stress to CellView::average, and V0 and the edges' sums.
void average_stress_lanes(const PointView& p, const CellView& c, SlotRange slots);
/// Adds V0 times ln det of the step's deformation; with `volumes` what does not depend on it too.
void average_strain_lanes(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          SlotRange slots);
/// A.8-A.11; `remap`: adds the updated momentum to CellView::straining.
GatherSums move_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, SlotRange slots);
/// A.12; F-bar of three-node shapes: with the averaged volumetric increment. With Where::before does what locate_lanes()
/// does too.
std::size_t strain_lanes(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, SlotRange slots,
                         const Increments& out, std::uint32_t* suspects);
/// Both together, three-node shapes with usl and apic (`strain.locking` none): the straining velocity is the updated one.
/// Does what locate_lanes() does too.
GatherSums move_strain_lanes(ShapeKind shape, const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c,
                             SlotRange slots, const Increments& out, std::uint32_t* suspects);
/// The same with F-bar, whose averages come first: adds what average_strain_lanes() does without `volumes`.
GatherSums move_average_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, SlotRange slots);
/// P v of XPIC: from the nodes' `v` to the points and back, times the mass, added to `out`; x and y of every node.
void project_lanes(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   SlotRange slots);
/// The instruction set that the kernels run on.
const char* simd_target();

}  // namespace pivnp::mpm

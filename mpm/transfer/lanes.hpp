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

#include "mpm/state/scheme.hpp"
#include "mpm/state/views.hpp"

namespace pivnp::mpm {

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
struct StrainIncrements {
  double *xx, *yy, *zz, *xy, *spin;
};

struct StrainJob {
  Locking locking;
  double dt;
  bool record;  // F and J too
  Where where = Where::now;
};

struct MoveJob {
  double dt, pic;          // share of PIC (flip, aflip)
  double reach2;           // greatest squared speed that is good
  const double* filtered;  // xpic: x, y of every node
  TransferKind transfer;
  bool remap;              // musl
  bool keep;               // natural coordinates, for Where::kept
};

/// Places in `order` of the points that are not in their cell, to `suspects`, whose number is returned.
std::size_t locate_lanes(const PointView& p, const CellView& c, Range range, std::uint32_t* suspects);
/// Adds mass, momentum and internal force to Node::mass, vx, vy, fx, fy. F-bar of three-node shapes: with the
/// average of the mean stress.
void map_lanes(ShapeKind shape, bool affine, bool momentum, bool force, Locking locking, const PointView& p,
               const CellView& c, Range range);
/// Axisymmetric: the force of the hoop stress, -sum_p V0 tau_zz N/r along x.
void map_hoop_lanes(ShapeKind shape, Locking locking, const PointView& p, const CellView& c, Range range);
/// Axisymmetric: PointView::hoop, ln(1 + dt v/r); with `record` PointView::F_zz too.
void hoop_lanes(ShapeKind shape, Where where, double dt, bool record, const PointView& p, const CellView& c, Range range);
/// Adds V0 times the mean stress to CellView::average, and V0 and the edges' sums.
void average_stress_lanes(const PointView& p, const CellView& c, Range range);
/// Adds V0 times ln det of the step's deformation; with `volumes` what does not depend on it too.
void average_strain_lanes(ShapeKind shape, Where where, double dt, bool volumes, const PointView& p, const CellView& c,
                          Range range);
/// A.8-A.11; `remap`: adds the updated momentum to CellView::strain_velocity.
GatherSums move_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range);
/// A.12; F-bar of three-node shapes: with the averaged volumetric increment. With `suspects` does what locate_lanes() does
/// too.
std::size_t strain_lanes(ShapeKind shape, const StrainJob& job, const PointView& p, const CellView& c, Range range,
                         const StrainIncrements& out, std::uint32_t* suspects);
/// Both together, three-node shapes with usl and apic or aflip (`strain.locking` none): the strain-rate velocity is the updated one.
/// Does what locate_lanes() does too.
GatherSums move_strain_lanes(ShapeKind shape, const MoveJob& job, const StrainJob& strain, const PointView& p, const CellView& c,
                             Range range, const StrainIncrements& out, std::uint32_t* suspects);
/// The same with F-bar, whose averages come first: adds what average_strain_lanes() does without `volumes`.
GatherSums move_average_lanes(ShapeKind shape, const MoveJob& job, const PointView& p, const CellView& c, Range range);
/// P v of XPIC: from the nodes' `v` to the points and back, times the mass, added to `out`; x and y of every node.
void project_lanes(ShapeKind shape, const double* v, double* out, const PointView& p, const CellView& c,
                   Range range);
/// The instruction set that the kernels run on.
const char* simd_target();

}  // namespace pivnp::mpm

// What the cells and nodes of a simulation carry during a step.
#pragma once

#include <cstdint>
#include <vector>

#include "mpm/grid/active_cells.hpp"
#include "mpm/grid/averages.hpp"
#include "mpm/grid/cell_list.hpp"
#include "mpm/grid/grid_geometry.hpp"
#include "mpm/grid/sleeping_blocks.hpp"
#include "mpm/state/node_fields.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/views.hpp"

namespace pivnp::mpm {

/// Points that may have changed their cell (locate_points()).
struct Relocation {
  std::vector<std::uint32_t> suspects;  // places in CellList::order of points that are not in their cell any more: in
  std::vector<Range> found;             // these ranges, one a piece of the active cells
  bool done = false;                    // the last sweep over the points has filled them
  std::vector<Move> moves;              // those that have another cell
};

/// The geometry, the points in its cells, and its nodes.
class GridState : public GridGeometry {
 public:
  /// `by_updated`: the updated velocity Node::n gives the strain increments, not one of its own.
  GridState(const Grid& domain, ShapeKind shape, int velocity_fields = 1, bool by_updated = false,
            const NodeNeeds& needs = {.own_strain_velocity = true, .averages = true}, bool axisymmetric = false);

  const bool by_updated;
  CellList cells;
  std::vector<std::uint8_t> marks;  // of each occupied cell: walls at its middle node (WallSide), strained_apart, at_edge
  SleepingBlocks blocks;
  ActiveCells active;
  Nodes node;                       // of the whole grid; zero where not active
  NodeArrays arrays;                // what else nodes carry, as far as it is needed; with room for a row and more beyond both ends
  bool averaged = false;            // at the corners of cells, since the start
  Relocation relocation;

  /// Builds the lists of cells and active nodes from Particles::cell.
  void rebuild(const Particles& particles);
  /// The same, where only these points (their places ascending) have another cell than before.
  void follow(const Particles& particles, const std::vector<Move>& moves);
  /// Walls beside the nodes from here on, those with tied sides (Restraints::wall_sides()), and by how much the nodes
  /// are moved onto walls (Restraints::node_shifts()).
  void set_walls(std::vector<std::uint8_t> of_nodes, std::vector<std::uint8_t> with_ties,
                 std::vector<Vec2> shifts = {});
  /// Which blocks sleep from here on; empty: none.
  void set_asleep(const std::vector<std::uint8_t>& blocks);

  /// Of a node, the velocity that gives the strain increments.
  struct StrainVelocity {
    double &x, &y;
  };
  StrainVelocity strain_velocity(std::size_t n) {
    return has_own_strain_velocity(n) ? StrainVelocity{arrays.own_strain_velocity[n].x, arrays.own_strain_velocity[n].y}
                                      : StrainVelocity{node[n].nx, node[n].ny};
  }
  Vec2 strain_velocity(std::size_t n) const {
    return has_own_strain_velocity(n) ? Vec2(arrays.own_strain_velocity[n].x, arrays.own_strain_velocity[n].y)
                                      : Vec2(node[n].nx, node[n].ny);
  }
  bool has_own_strain_velocity(std::size_t n) const { return !by_updated || node[n].apart; }
  /// `by_updated`: until join_strain_velocities() the cells that see this node (or `count` in a row) are strained by
  /// velocities that their nodes have of their own, which are the updated ones as yet.
  void separate_strain_velocities(std::uint32_t node, int count = 1);
  void join_strain_velocities();

  /// Of the averages at the cells' corners. (A row and one more are read before the grid, two rows and some after.)
  AverageArrays averages();
  /// As the kernels see it.
  CellView view();

 private:
  void mark_cells();
  void move_nodes();
  void list_active();

  std::vector<std::uint32_t> cells_apart_, nodes_apart_;
};

/// The strain-rate velocity at a place; beyond occupied cells that of the nearest, two cells away at most, else zero.
Vec2 velocity_at(const GridState& g, const Vec2& x);

}  // namespace pivnp::mpm

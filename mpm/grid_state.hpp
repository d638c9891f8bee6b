// Which cells hold which points, and what the nodes carry during a step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mpm/particles.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

struct Node {
  double mass = 0;          // kg/m
  double vx = 0, vy = 0;    // velocity mapped from the points, m/s
  double fx = 0, fy = 0;    // force on the node, N/m
  double nx = 0, ny = 0;    // velocity after the momentum update and the restraints
  double ux = 0, uy = 0;    // velocity mapped again from the updated points (MUSL), restrained
  double dx = 0, dy = 0;    // damping force, part of the force, N/m
};

/// What the points of one cell give to its four nodes: one row a corner, corners in the order of bilinear_nodes().
struct CellSums {
  double mass[4], px[4], py[4], fx[4], fy[4];
};

/// Occupied cells have slots, in the order of their index. Each slot's sums are formed by one thread over the cell's
/// points in storage order, and each node adds its four slots in a fixed order: so the bits do not depend on the
/// number of threads, and only occupied cells cost anything.
class GridState {
 public:
  explicit GridState(const Grid& grid);

  const Grid grid;
  const double per_hx, per_hy;

  std::vector<std::uint32_t> order;       // points, cell after cell
  std::vector<std::int32_t> slot_cell;    // cell of a slot
  std::vector<std::uint32_t> slot_begin;  // its points in `order`; one more at the end
  std::vector<CellSums> sums;             // of a slot; one more, of zeros, at the end
  std::vector<std::uint32_t> nodes;       // active nodes (corners of occupied cells), in the order of their index
  // Slots to the upper right, upper left, lower right and lower left of a node; slots() where the cell is empty.
  std::vector<std::array<std::uint32_t, 4>> node_slots;
  std::vector<Node> node;                 // of the whole grid; zero where not active

  std::size_t slots() const { return slot_cell.size(); }
  /// Flat index of a slot's lower left node.
  std::size_t corner(std::size_t slot) const {
    const auto cell = std::size_t(slot_cell[slot]), across = std::size_t(grid.nx - 1);
    return cell + cell / across;
  }
  /// Builds order, slots and active nodes from Particles::cell.
  void rebuild(const Particles& particles);
  /// MUSL velocity at a point, bilinear; beyond occupied cells that of the nearest, two cells away at most, else zero.
  Vec2 velocity_at(const Vec2& x) const;
  /// Moves `at`, the element point of x, to the nearest one of a cell with material, two cells away at most.
  bool nearest_with_material(const Vec2& x, ElementPoint& at) const;

 private:
  void rebuild_nodes();

  std::vector<std::int32_t> slot_of_cell_;  // -1: empty
  std::vector<std::uint32_t> count_;
};

}  // namespace pivnp::mpm

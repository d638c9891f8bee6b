// Where the cells and nodes of a simulation are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/grid/shape.hpp"
#include "mpm/state/particles.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// A "cell" is the set of points that share their nodes: an element for bilinear shapes, the square around a node for
/// uGIMP and B-splines (shape.hpp); it goes by its lower left node.
///
/// Bodies in contact have a velocity field each (contact.hpp), with nodes of its own over the whole domain. The fields'
/// nodes lie one above the other in `grid`, `field_rows` rows apart, and a point's cell says to which it belongs; so what
/// is done cell by cell and node by node knows nothing of them. Without contact there is one.
class GridGeometry {
 public:
  /// Points live in `domain`. Cells around nodes need a ring of nodes around it, which `field_grid` has.
  GridGeometry(const Grid& domain, ShapeKind shape, int velocity_fields = 1, bool axisymmetric = false);

  const ShapeKind shape;
  const int width;     // nodes an axis of a stencil
  const int stencil;   // width^2
  const bool axisymmetric;  // x is the distance from the axis
  const bool centred;  // cells are squares around nodes; else elements
  const int origin;    // of a cell, from its lower left node, in nodes along each axis
  const Grid domain, field_grid;  // field_grid: with the ring
  const int velocity_fields, field_rows;
  const Grid grid;  // all fields; only the first one's nodes are where this says (position())
  const double per_hx, per_hy;
  std::vector<std::uint8_t> walls;  // WallSide, of every node of the grid
  std::vector<std::uint8_t> sides;  // likewise, and tied sides: shapes go on through these
  std::vector<Vec2> shift;          // of every node of the grid that is moved onto a wall, m; empty: of none
  std::vector<MovedNodes> moved;    // of every cell; likewise

  std::size_t field_nodes() const { return std::size_t(field_rows) * std::size_t(grid.nx); }
  /// Where a node is in the lattice.
  Vec2 position(std::size_t node) const {
    node %= field_nodes();
    return field_grid.position(int(node % std::size_t(grid.nx)), int(node / std::size_t(grid.nx)));
  }
  /// Where it is: at its wall, if it is moved there.
  Vec2 place(std::size_t node) const { return shift.empty() ? position(node) : Vec2(position(node) + shift[node]); }
  /// By what a volume of a unit of area at a node is multiplied: 1, or its radius (at the axis that of a hat there).
  double measure(std::size_t node) const { return axisymmetric ? std::max(position(node).x(), domain.spacing.x() / 6) : 1.0; }
  /// Flat indices of a cell's nodes, row after row.
  void stencil_nodes(std::int32_t cell, std::size_t* out) const;
  /// The cell of a place and its natural coordinates; false outside the domain (round-off of 1e-9 spacings is inside).
  bool find(double x, double y, std::int32_t& cell, double& xi, double& eta, int velocity_field = 0) const;
  /// Natural coordinates of a point in its cell.
  Vec2 natural(const Particles& p, std::size_t k) const;
  /// Nodes and weights of a place found by find(), as the walls modify them (a point of uGIMP as seeded four an element).
  void weights_at(std::int32_t cell, double xi, double eta, std::size_t* at, double* weights) const;
  /// The walls beside a cell's middle node; none for elements.
  std::uint8_t walls_of(std::int32_t cell) const {
    return centred ? walls[std::size_t(cell + grid.nx + 1)] : std::uint8_t(wall_none);
  }
  const MovedNodes* moved_in(std::int32_t cell) const { return moved.empty() ? nullptr : &moved[std::size_t(cell)]; }
  /// Of a cell in this row: its walls, at_edge and wall_moved.
  std::uint8_t marks_of(std::int32_t cell, int row) const;
};

}  // namespace pivnp::mpm

// Which cells hold which points, and what the nodes carry during a step.
#pragma once

#include <cstdint>
#include <vector>

#include "mpm/particles.hpp"
#include "mpm/shape.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

struct Node {
  double mass = 0;          // kg/m
  double vx = 0, vy = 0;    // velocity mapped from the points, m/s
  double fx = 0, fy = 0;    // force on the node, N/m
  double nx = 0, ny = 0;    // velocity after the momentum update and the restraints
  double ux = 0, uy = 0;    // velocity that strains the material (MUSL: mapped again), restrained
  double dx = 0, dy = 0;    // damping force, part of the force, N/m
  bool held = false;        // by a wall or body
};

/// A "cell" is the set of points that share their nodes: an element for bilinear shapes, the square around a node for
/// uGIMP and B-splines (shape.hpp); it goes by its lower left node. Occupied cells have slots, in the order of their
/// index. Each slot's sums are formed by one thread over the cell's points in storage order, and each node adds its
/// slots in a fixed order: so the bits do not depend on the number of threads, and only occupied cells cost anything.
class GridState {
 public:
  /// Points live in `domain`. Shapes of three nodes an axis need a ring of nodes around it, which `grid` has.
  GridState(const Grid& domain, ShapeKind shape);

  const ShapeKind shape;
  const int width;    // nodes an axis of a stencil
  const int stencil;  // width^2
  const Grid domain, grid;
  const double per_hx, per_hy;

  std::vector<std::uint32_t> order;       // points, cell after cell
  std::vector<std::int32_t> slot_cell;    // cell of a slot
  std::vector<std::uint32_t> slot_begin;  // its points in `order`; one more at the end
  std::vector<std::uint8_t> slot_fold;    // walls at the slot's middle node (Fold)
  /// What a slot gives to its nodes: [slot][quantity][stencil node], 5 quantities (mass, momentum, force); one slot
  /// more, of zeros, at the end.
  std::vector<double> sums;
  std::vector<std::uint32_t> nodes;       // active nodes (of occupied cells), in the order of their index
  std::vector<std::uint32_t> node_slots;  // [active node][stencil node]: the slot that has it there; slots(): none
  std::vector<Node> node;                 // of the whole grid; zero where not active
  std::vector<std::uint8_t> fold;         // of every node of the grid

  static constexpr int quantities = 5;
  std::size_t slots() const { return slot_cell.size(); }
  double* slot_sums(std::size_t slot) { return sums.data() + slot * std::size_t(quantities * stencil); }
  /// Flat indices of a slot's nodes, row after row.
  void stencil_nodes(std::size_t slot, std::size_t* out) const;

  /// The cell of a point and its natural coordinates; false outside the domain (round-off of 1e-9 spacings is inside).
  bool find(double x, double y, std::int32_t& cell, double& xi, double& eta) const;
  /// Nodes and weights of a place found there, with the walls' folds (a point of uGIMP as seeded four an element).
  void weights_at(std::int32_t cell, double xi, double eta, std::size_t* at, double* weights) const;
  /// Builds order, slots and active nodes from Particles::cell.
  void rebuild(const Particles& particles);
  /// Walls of the nodes from here on (Restraints::folds).
  void set_folds(const std::vector<std::uint8_t>& folds);
  /// The straining velocity at a point; beyond occupied cells that of the nearest, two cells away at most, else zero.
  Vec2 velocity_at(const Vec2& x) const;

 private:
  void rebuild_nodes();
  std::int32_t slot_near(const Vec2& x, double& xi, double& eta) const;
  std::uint8_t fold_of(std::int32_t cell) const;

  std::vector<std::int32_t> slot_of_cell_;  // -1: empty
  std::vector<std::uint32_t> count_;
};

}  // namespace pivnp::mpm

// Restraints on nodes: walls, bases, gates.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/reaction.hpp"
#include "mpm/constraint/tied_sides.hpp"
#include "mpm/constraint/wall.hpp"
#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

/// fixed: no motion. roller: no motion along the normal, either way. frictional: no motion along the normal outward;
/// the tangential impulse is at most friction times the normal one; separation is free (the nodal form of Coulomb's
/// law, as in Bardenhagen, Brackbill & Sulsky 2000 for a wall at rest). absorbing: dashpots rho c_p across and rho c_s
/// along the wall (Lysmer & Kuhlemeyer 1969), taken implicitly, so that they do not bound the step. tied: tied_sides.hpp.
///
/// A fixed restraint may give its nodes a velocity; any may be drawn away at a speed (withdrawal.hpp).
class Restraints {
 public:
  /// Throws InputError naming boundary.<name>.<key> (walls_of()).
  Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const GridGeometry& g,
             const Vec2& centroid, const Impedance& impedance, bool may_move_nodes = true);

  /// Restrains Node::nx, ny; the impulses are appended to `reactions`, and added to those of their walls, where `of_walls` has
  /// one for each of walls(). With dt = 0 (initial equilibrium) absorbing walls are fixed.
  void apply(double time, double dt, GridState& g, std::vector<Reaction>& reactions, std::span<Impulse> of_walls = {});
  /// The nodes where walls of some friction hold material now.
  std::vector<std::uint32_t> rubbing(double time, const GridState& g) const;
  /// What excess pressure in the pores presses the material's face with at each of them, N s/m in a step: friction in the next
  /// apply() follows what the skeleton bears of the normal impulse. Both empty: nothing presses.
  void press(std::span<const std::uint32_t> nodes, std::span<const Vec2> impulses, const GridState& g);
  /// The motion that apply() left a node, as a projection: the unit matrix where no wall holds it.
  Mat2 mobility(std::size_t node) const;
  /// The directions in which walls hold a node at time 0 against gravity, as a sum of projections (walls with friction
  /// hold along themselves too).
  Mat2 hold(std::size_t node, const Vec2& gravity) const;
  /// Restrains the strain-rate velocity alike; nodes that stuck in apply() stay.
  void apply_to_strain_velocity(double time, GridState& g, bool equilibrium = false) const;
  /// The first time after `time` at which a restraint goes.
  double next_change(double time) const;
  /// Behind which walls nothing is, for every node of the grid (WallSide); `tied`: behind tied sides, too.
  std::vector<std::uint8_t> wall_sides(double time, const Grid& grid, bool tied) const;
  /// By how much every node of the grid is moved onto its walls, m; empty where none is.
  std::vector<Vec2> node_shifts(double time, const Grid& grid) const;
  bool any_absorbing() const;
  const TiedSides& tied() const { return tied_; }
  const std::vector<Wall>& walls() const { return walls_; }

 private:
  struct RestrainedNode {
    std::uint32_t node;
    Vec2 place;  // of the node, m
    std::vector<std::uint16_t> walls;
    std::vector<double> until;  // of each wall at this node
    bool stuck = false;
    Vec2 pressed = Vec2::Zero();  // press(), over the node's mass
    Mat2 mobility = Mat2::Identity();
  };
  void hold_beyond_ties(std::vector<RestrainedNode>& at_node) const;
  Mat2 mobility_of(const RestrainedNode& at, double time, const Vec2& free, bool equilibrium) const;
  void add_impulse(const RestrainedNode& at, double time, const Vec2& impulse, std::span<Impulse> of_walls) const;
  Vec2 given_velocity(const RestrainedNode& at, double time, bool equilibrium) const;
  Vec2 absorbed(const RestrainedNode& at, double time, double dt, const GridState& g, Vec2 v) const;
  Vec2 restrain(const RestrainedNode& at, double time, Vec2 v, bool with_friction, bool& stuck, bool equilibrium) const;
  void apply_friction(const RestrainedNode& at, double time, Vec2& v, bool with_friction, bool& stuck) const;

  bool any_rubs() const;
  std::vector<Wall> walls_;
  TiedSides tied_;
  std::vector<RestrainedNode> nodes_;  // in the order of their index
  std::vector<double> changes_;        // times at which a restraint goes somewhere
};

}  // namespace pivnp::mpm

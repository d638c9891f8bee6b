// The momentum balance at the nodes, and the work done there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mpm/constraint/restraints.hpp"
#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

/// Nodes with next to no mass move with their neighbours, since their force over their mass would be any number:
/// docs/theory/mpm.md#small-mass-nodes. Momenta and forces go to what they move with, so momentum is conserved; as a constraint
/// on the motion it does no work.
struct SmallMassNodes {
  /// Which are small (kg/m a node of a plane mesh), and how they move.
  struct Rule {
    double least;
    bool linear;  // by 2 v(1) - v(2) of the two nodes next in the direction of the material, where both have mass; else all as the heaviest
  };
  using Pair = JoinedNode;
  std::vector<Pair> pairs;  // ascending by `small`
  void find(const GridState& g, const Rule& rule);
  /// The same of those listed, if they are lighter.
  void pair_up(const GridState& g, const Rule& rule, const std::vector<std::uint32_t>& nodes);
  /// After update_momentum(): the common motion to Node::n of all.
  void join_momentum(GridState& g, double damping, double dt) const;
  /// The strain-rate velocity of the small ones follows from their neighbours'.
  void join_velocity(GridState& g) const;
};

/// A.5-A.7: adds gravity, then Cundall's local damping -alpha |f| sign(v) by component, and advances Node::n.
void update_momentum(GridState& g, const Vec2& gravity, double damping, double dt, int threads);

/// A.3-A.7 together, each node as soon as its sums are complete, and the small nodes by `rule` to `small`: for
/// steps in which nothing asks for the mapped velocity in between.
void map_and_update(const Particles& p, GridState& g, const Scheme& scheme, SmallMassNodes& small, const SmallMassNodes::Rule& rule,
                    const Vec2& gravity, double dt, int threads);

/// Work of one step, J/m.
struct NodalWork {
  double damping = 0;   // taken out by local damping
  double contact = 0;   // taken out by friction and impact at walls and bodies, and by absorbing walls
  double bodies = 0;    // done by moving bodies
  double kinetic = 0;   // of all impulses together
};

/// A node that a rigid body touched in the last step, and the velocity by which it strained the material then.
struct TouchedNode {
  std::uint64_t node;
  double x, y;
};

/// The work of an impulse is impulse . w, where w is the mean of the mapped velocity v and the one that strains the
/// material (`strained`: GridState::strain_velocity(); else Node::n), and at held nodes the latter alone: v there is what the
/// points would do without the wall. With it the work of the stresses is what the points' energy changes by. At nodes in
/// `touched` (ascending) w is the mean of the velocities that strained the material in the last step and in this one: v stands
/// for the former elsewhere, but not where a body has changed the one and not the other.
NodalWork nodal_work(const GridState& g, const std::vector<Reaction>& reactions, std::span<const TouchedNode> touched, double damping,
                     double dt, bool strained, int threads);

/// Without regard to what was touched; and what that adds to it.
Vec2 working_velocity(const GridState& g, std::size_t node, bool strained);
Vec2 working_velocity_by_touch(const GridState& g, const TouchedNode& touched, bool strained);

/// 1/2 m n^2 of the active nodes, J/m, and the greatest squared speed of those heavier than `least` (kg/m).
struct NodalMotion {
  double kinetic = 0, fastest2 = 0;
};
NodalMotion nodal_motion(const GridState& g, double least);

}  // namespace pivnp::mpm

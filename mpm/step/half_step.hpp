// Leap-frog: the velocities of a state are those of the middle of the step before it.
//
// A step pushes the nodes for half of the last step and half of its own, so that a run's first step, before which
// velocities are those of time 0, pushes them for half of its time: loads that act at once are of second order. What is
// shown of a state (frames, energies, impulses) is brought to its time by what half of the last step changed.
#pragma once

#include "mpm/grid/grid_state.hpp"
#include "mpm/step/momentum.hpp"

namespace pivnp::mpm {

/// The last push of the nodes, and the step in which it was given; both 0 where nothing is known of one, or nothing missing.
struct LastPush {
  double push_s = 0, step_s = 0;
  double contact = 0, damping = 0, bodies = 0;  // work done in the push, J/m
  /// Of the push, what would lead to the end of the step.
  double share() const { return step_s > 0 ? 0.5 * step_s / push_s : 0; }
};

struct VelocityChange {
  Vec2 v = Vec2::Zero();
  Mat2 affine = Mat2::Zero();
};

/// What that share of the last push adds to a point's velocity. At nodes that a wall or a body has hold of it counts no more, along
/// each axis, than the forces alone would change: an impact is not half undone, and a wall's hold on moving material is no acceleration.
VelocityChange pushed_on(const Particles& p, const GridState& g, std::size_t k, const LastPush& last);

/// The kinetic energy of all points with that.
double pushed_kinetic(const Particles& p, const GridState& g, const LastPush& last);
/// What it adds to their momentum: exactly what the nodes have of it.
Vec2 pushed_momentum(const Particles& p, const GridState& g, const LastPush& last);

}  // namespace pivnp::mpm

// The momentum balance at the nodes, and the work done there.
#pragma once

#include <vector>

#include "mpm/boundary.hpp"
#include "mpm/grid_state.hpp"

namespace pivnp::mpm {

/// A.5-A.7: adds gravity, then Cundall's local damping -alpha |f| sign(v) by component, and advances Node::nx, ny.
void update_momentum(GridState& g, const Vec2& gravity, double damping, double dt, int threads);

/// Work of one step, J/m.
struct NodalWork {
  double damping = 0;   // taken out by local damping
  double contact = 0;   // taken out by friction and impact at walls and bodies
  double bodies = 0;    // done by moving bodies
};

/// A nodal impulse changes the points' kinetic energy by impulse . (v + u)/2, exactly for FLIP, where v is the mapped
/// velocity and u the one mapped again, before it is restrained: call between the two.
NodalWork nodal_work(const GridState& g, const std::vector<Reaction>& reactions, double damping, double dt);

}  // namespace pivnp::mpm

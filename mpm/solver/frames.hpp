// From a scene to the solver's first state, and from any state to a frame of motion.
#pragma once

#include "mpm/constraint/contact.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/scene/scene.hpp"
#include "mpm/solver/state.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/stress_update.hpp"

namespace pivnp::mpm {

/// Throws InputError for arrays of unequal length and for a particle outside the grid.
SolverState initial_state(const Scene& scene, const Scheme& scheme, const GridState& g, const Materials& materials,
                          const Contacts& contacts = Contacts({}, {}));

MotionFrame frame_of(const SolverState& state, const ParticleSet& particles);

}  // namespace pivnp::mpm

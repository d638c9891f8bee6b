// The part of the energy that leapfrog's stable steps take and give back (docs/theory/mpm.md#leapfrogs-swing).
#pragma once

#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/step/half_step.hpp"

namespace pivnp::mpm {

struct Swing {
  double energy = 0;  // in the balance with velocities of half a step ago, J/m
  double share2 = 0;  // (omega dt/2)^2 by Rayleigh's quotient; from 1 on steps are too long for the motion
};

/// After a step. Forces of the new stresses are mapped where the points were, for which they are conjugate to the last
/// strains.
Swing leapfrog_swing(const Particles& p, GridState& g, const Scheme& scheme, const Vec2& gravity, const LastPush& last,
                     int threads);

}  // namespace pivnp::mpm

// From options and scene to what the solver works on, and back to a frame.
#pragma once

#include "mpm/material/stress_update.hpp"
#include "mpm/solver.hpp"
#include "mpm/solver_state.hpp"

namespace pivnp::mpm {

/// The numerical choices a scheme's name stands for, with what the options say instead.
struct Scheme {
  double damping = 0;    // Cundall's local damping
  double pic_share = 0;  // of PIC, while a wave crosses one cell: per step 1 - exp(-share dt c/h)
};
/// Throws InputError naming mpm.scheme.
Scheme scheme_of(const MpmOptions& options);

/// Throws InputError naming the material; `scene.materials` has one entry a label.
Materials materials_of(const Scene& scene);
Vec2 centroid(const ParticleSet& particles);
double fastest_wave(const Scene& scene, const Materials& materials);

/// Throws InputError for arrays of unequal length and for a particle outside the grid.
SolverState initial_state(const Scene& scene);

MotionFrame frame_of(const SolverState& state, const ParticleSet& particles);

}  // namespace pivnp::mpm

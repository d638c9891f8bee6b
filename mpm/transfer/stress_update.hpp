// The laws of all bodies, called on runs of their points.
#pragma once

#include <memory>
#include <vector>

#include "mpm/material/material.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/scheme.hpp"
#include "mpm/transfer/lanes.hpp"

namespace pivnp::mpm {

using Materials = std::vector<std::unique_ptr<Material>>;

/// A.20-A.24: stress of every point from its increments. Each law gets runs of at most 1024 points of its body. `dt_s`:
/// length of the step; 0 for the initial equilibrium.
void update_stress(const Materials& materials, Particles& p, int threads, double dt_s = 0);

/// strain_points() and update_stress(), run by run of cells, without the arrays of increments in Particles. Returns the
/// work that strain_and_update() returns; `moved` as there.
double strain_and_update_stress(const Materials& materials, Particles& p, GridState& g, const Scheme& scheme, double dt,
                                int threads, GatherSums* moved = nullptr);

/// The fastest compression wave as the points are now; densities at the start, one a material. `added`: what water adds to
/// each material's stiffness, Pa; may be empty. m/s.
double wave_speed(const Materials& materials, const std::vector<double>& density, Particles& p, int threads,
                  const std::vector<double>& added = {});

}  // namespace pivnp::mpm

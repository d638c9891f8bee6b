// The scenes that simulations are stressed by. Each is there on cells of its own and, for its reference, on cells half as large or less.
#pragma once

#include <vector>

#include "apps/study/stress/mpm/trial.hpp"

namespace pivnp::app {

/// A column of sand that collapses: step, material points, bulk stiffness, stiffness.
std::vector<TrialMap> column_trials();
/// Elastic bodies: cells crossed, slivers of a cell, flight, impact, stiffness contrast.
std::vector<TrialMap> body_trials();
/// Soil: softening against the mesh, thin layers.
std::vector<TrialMap> soil_trials();
/// Soil with water: permeability and step, undrained loading.
std::vector<TrialMap> water_trials();

}  // namespace pivnp::app

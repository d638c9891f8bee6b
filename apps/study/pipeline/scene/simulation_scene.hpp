// The scene of a case's simulation, on the nodes of the measurement.
#pragma once

#include <string>

#include "apps/study/pipeline/scene/scene.hpp"
#include "mpm/solver/solver.hpp"

namespace pivnp::app {

/// The simulation's grid: the measured one refined, then extended or cut to whole cells that cover the domain. Throws
/// InputError, naming the key, where it holds no cell or too many nodes.
Grid simulation_grid(const Case& c, const Grid& measured, const mpm::MpmOptions& options);

/// The name of a region's material: its own where the case gives none.
std::string material_of(const Case& c, const Region& region);

/// The simulation's scene on the same nodes: `options` refine, extend and seed; materials by region. Material points
/// under the mask are kept (masks hide, they do not dig), those inside a rigid body are not seeded.
mpm::Scene make_scene(const Case& c, const Setting& setting, const mpm::MpmOptions& options,
                      const Named<mpm::MaterialOptions>& materials, const std::string& materials_table);

/// The case's simulation of make_scene(). What the solver refuses is told with the case's file.
mpm::Solver make_solver(const Case& c, const Setting& setting, int threads);

}  // namespace pivnp::app

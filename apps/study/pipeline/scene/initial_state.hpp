// What a case's simulation starts with: velocities, stresses and pressures by region.
#pragma once

#include "apps/case/case.hpp"
#include "mpm/scene/scene.hpp"

namespace pivnp::app {

/// Scene::v0, grad_v0, stress0 and pressure0 of [initial.REGION]; left empty where no section asks for them. Throws
/// InputError with file and key for a file that cannot be read, or that ends before the region does.
void put_initial_state(const Case& c, mpm::Scene& scene);

}  // namespace pivnp::app

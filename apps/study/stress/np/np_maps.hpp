// Numerical particles from easy to hopeless.
#pragma once

#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/np/options.hpp"

namespace pivnp::app {

/// Particles that ride through vectors of known motions, 16 px apart, with random errors whose size they state. Right: the path ends less
/// than .1 px from where the material does; wrong: more than .5 px. Trusted: the particle is active, and twice the standard error that it
/// states is below the latter; one that has ended claims no value.
std::vector<MapPlan> np_maps(const np::NpOptions& options);

}  // namespace pivnp::app

// Zones of a case that must hold material.
#pragma once

#include "apps/case/case.hpp"
#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// Before anything is computed: throws InputError, naming the key, for a zone of [compare] that holds too few numerical
/// particles or material points for what is taken from it. For cases that measure and simulate.
void check_compared_zones(const Case& c, const Setting& setting);

}  // namespace pivnp::app

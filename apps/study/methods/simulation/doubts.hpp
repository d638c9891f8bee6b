// What a simulation is known to get wrong before it runs.
#pragma once

#include <string>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "mpm/scene/options.hpp"
#include "mpm/scene/scene.hpp"

namespace pivnp::app {

/// A sentence each (pivnp stress maps them).
std::vector<std::string> doubts(const mpm::MpmOptions& options, const mpm::Scene& scene);
/// The same of a case with [mpm], and what no soil has, by name of the key. Throws InputError as make_scene().
std::vector<std::string> doubts(const Case& c, const Setting& setting);
/// Of the camera.
std::vector<std::string> doubts_of_scale(const Case& c);

}  // namespace pivnp::app

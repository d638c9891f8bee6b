// What a reader needs to repeat the simulation: materials, cells, step, walls, loads.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "apps/case/case.hpp"

namespace pivnp::app {

/// What, and how it was; none without [mpm]. `spacing`: of the measured grid; `points`: material points. Of each section the keys that were chosen otherwise than they are by
/// default, of a material those that its law takes.
std::vector<std::pair<std::string, std::string>> simulation_setup(const Case& c, double spacing, std::size_t points);

}  // namespace pivnp::app

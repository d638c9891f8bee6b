// Which nodes of a pair have material in front of them.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// 1: material; 0: outside, where a window shows the background and its vector says nothing. One value a node of
/// `field`; empty where no particles were followed, so that it is not known. Material is where the deformed square of a
/// particle, a third larger, lies at the pair's first frame. A particle that was lost holds its last place: there is
/// material, and that it could not be measured must show.
std::vector<std::uint8_t> nodes_in_material(const Content& content, const VectorField& field);

}  // namespace pivnp::report

// Which nodes of a grid have material in front of them.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/grid/grid.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp {

/// 1: material; 0: none, where a window shows the background and its vector says nothing. One value a node; empty where the
/// motion has no frame near `time`, so that it is not known. Material is where the deformed square of a particle, a third
/// larger, lies. A particle that was lost holds its last place: there is material, and that it could not be measured must
/// show.
std::vector<std::uint8_t> covered_nodes(const MotionSource& motion, double time, const Grid& grid);

}  // namespace pivnp

// Which nodes of a pair have material in front of them.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/report/content/content.hpp"

namespace pivnp::report {

/// 1: material; 0: outside, where a window shows the background and its vector says nothing. One value a node of
/// `field`; empty where no particles were followed, so that it is not known. As the record states it, and of records before
/// 1.7 by covered_nodes (pivnp/core/particles/coverage.hpp) at the pair's first frame.
std::vector<std::uint8_t> nodes_in_material(const Content& content, const VectorField& field);

}  // namespace pivnp::report

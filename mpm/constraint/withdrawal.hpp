// Restraints that are drawn away (a gate).
#pragma once

#include "mpm/constraint/options.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// When a boundary lets a node at `x` go: when its shape, moving, is a hundredth of a cell further from the node than it
/// was (inside a polygon, when its trailing side has passed; next to a line, when its trailing end has), but at `until` at
/// the latest. On a raster of a tenth of a cell, so that rows of nodes go together and the steps are not cut to pieces.
double release_time(const BoundaryOptions& options, double until, const Vec2& x, double spacing);

}  // namespace pivnp::mpm

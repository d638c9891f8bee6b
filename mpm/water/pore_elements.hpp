// Where points are between the nodes that the water flows along.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

/// The element between nodes that a point is in: its lower left node, and the point's place from there, in cells.
struct InElement {
  std::size_t node;
  double s, t;
};

inline InElement element_of(const Particles& p, const GridState& g, std::size_t k) {
  const Vec2 at = g.natural(p, k);
  const auto cell = std::size_t(p.cell[k]);
  if (!g.centred) return {cell, std::clamp(at.x(), 0.0, 1.0), std::clamp(at.y(), 0.0, 1.0)};
  const std::size_t left = at.x() < 0, below = at.y() < 0, row = std::size_t(g.grid.nx);
  return {cell + row + 1 - left - below * row, at.x() + double(left), at.y() + double(below)};
}

/// Rate at which a cell's own water evens out, over the diffusivity, 1/m^2.
inline double rate_in_cell(const GridState& g) { return 2 * (g.per_hx * g.per_hx + g.per_hy * g.per_hy); }

/// Calls each(k) for the points of some occupied cells.
template <class Each>
void for_points_of(const GridState& g, Range cells, Each&& each) {
  for (std::uint32_t q = g.cells.begin[cells.begin]; q < g.cells.begin[cells.end]; ++q) each(g.cells.order[q]);
}

}  // namespace pivnp::mpm

#include "pivnp/core/grid/grid.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace pivnp {

namespace {

// One axis of locate(): the cell index and the natural coordinate, or false.
bool locate_axis(double s, int nodes, int& cell, double& natural) {
  constexpr double round_off = 1e-9;
  if (!(s >= -round_off && s <= nodes - 1 + round_off)) return false;  // also catches NaN
  cell = std::clamp(static_cast<int>(std::floor(s)), 0, nodes - 2);
  natural = std::clamp(s - cell, 0.0, 1.0);
  return true;
}

}  // namespace

bool locate(const Grid& grid, const Vec2& x, ElementPoint& point) {
  if (grid.nx < 2 || grid.ny < 2) return false;
  ElementPoint found;
  if (!locate_axis((x.x() - grid.origin.x()) / grid.spacing.x(), grid.nx, found.i, found.xi)) return false;
  if (!locate_axis((x.y() - grid.origin.y()) / grid.spacing.y(), grid.ny, found.j, found.eta)) return false;
  point = found;
  return true;
}

Grid padded(const Grid& grid, int cells) {
  assert(cells >= 0);
  return {grid.position(-cells, -cells), grid.spacing, grid.nx + 2 * cells, grid.ny + 2 * cells};
}

Grid refined(const Grid& grid, int factor) {
  assert(factor >= 1);
  return {grid.origin, grid.spacing / factor, (grid.nx - 1) * factor + 1, (grid.ny - 1) * factor + 1};
}

}  // namespace pivnp

// The strain-rate velocity at any place.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

namespace {

// The occupied cell of a velocity field that is nearest to a place, and where in it; -1: none.
struct Nearest {
  std::int32_t at = -1;
  double xi = 0, eta = 0;
  double distance2 = std::numeric_limits<double>::infinity();
};

Nearest nearest_cell(const GridState& g, const Vec2& x, int velocity_field) {
  std::int32_t cell = 0;
  Nearest best;
  if (!g.find(x.x(), x.y(), cell, best.xi, best.eta, velocity_field)) return {};
  best.at = g.cells.find(cell);
  if (best.at >= 0) {
    best.distance2 = 0;
    return best;
  }
  const int first = velocity_field * g.field_rows, i0 = int(cell % g.grid.nx), j0 = int(cell / g.grid.nx);
  const double x0 = best.xi, y0 = best.eta, low = g.centred ? -0.5 : 0.0;
  constexpr int reach = 2;  // cells
  for (int j = std::max(first, j0 - reach); j <= std::min(first + g.field_grid.ny - g.width, j0 + reach); ++j)
    for (int i = std::max(0, i0 - reach); i <= std::min(g.grid.nx - g.width, i0 + reach); ++i) {
      const std::int32_t s = g.cells.find(std::int32_t(g.grid.node(i, j)));
      if (s < 0) continue;
      const double here_x = x0 - (i - i0), here_y = y0 - (j - j0);  // from that cell
      const double in_x = std::clamp(here_x, low, low + 1), in_y = std::clamp(here_y, low, low + 1);
      const double away = std::pow((here_x - in_x) * g.grid.spacing.x(), 2) +
                          std::pow((here_y - in_y) * g.grid.spacing.y(), 2);
      if (away < best.distance2) best = {s, in_x, in_y, away};
    }
  return best;
}

}  // namespace

// Of several fields the one whose material is nearest; where they are equally near, the one with more mass.
Vec2 velocity_at(const GridState& g, const Vec2& x) {
  Vec2 v = Vec2::Zero();
  double nearest = std::numeric_limits<double>::infinity(), heaviest = 0;
  for (int k = 0; k < g.velocity_fields; ++k) {
    const Nearest cell = nearest_cell(g, x, k);
    if (cell.at < 0 || cell.distance2 > nearest) continue;
    std::size_t at[most_stencil_nodes];
    double w[most_stencil_nodes], mass = 0;
    g.weights_at(g.cells.index[std::size_t(cell.at)], cell.xi, cell.eta, at, w);
    Vec2 here = Vec2::Zero();
    for (int c = 0; c < g.stencil; ++c) {
      here += w[c] * g.strain_velocity(at[c]);
      mass += w[c] * g.node[at[c]].mass;
    }
    if (cell.distance2 == nearest && mass <= heaviest) continue;
    nearest = cell.distance2;
    heaviest = mass;
    v = here;
  }
  return v;
}

}  // namespace pivnp::mpm

#include "mpm/grid/grid_geometry.hpp"

#include <algorithm>

namespace pivnp::mpm {

namespace {

constexpr double round_off = 1e-9;  // of a cell, as in pivnp::locate

bool any_moved(const MovedNodes* of) {
  return of && (of->low[0] != 0 || of->low[1] != 0 || of->high[0] != 0 || of->high[1] != 0);
}

// At least one row stays empty between two velocity fields, and each begins a new band of rows.
int rows_of_field(int ny, int velocity_fields) {
  constexpr int multiple = 8;
  return velocity_fields == 1 ? ny : (ny + multiple) / multiple * multiple;
}

}  // namespace

GridGeometry::GridGeometry(const Grid& d, ShapeKind kind, int n_fields, bool about_axis)
    : shape(kind),
      width(row_of(kind).nodes),
      stencil(width * width),
      axisymmetric(about_axis),
      centred(row_of(kind).centred()),
      origin(centred ? 1 : 0),
      domain(d),
      field_grid(centred ? padded(d, 1) : d),
      velocity_fields(n_fields),
      field_rows(rows_of_field(field_grid.ny, n_fields)),
      grid{field_grid.origin, field_grid.spacing, field_grid.nx, n_fields == 1 ? field_grid.ny : n_fields * field_rows},
      per_hx(1 / d.spacing.x()),
      per_hy(1 / d.spacing.y()),
      walls(grid.node_count(), wall_none) {}

void GridGeometry::stencil_nodes(std::int32_t cell, std::size_t* out) const {
  for (int b = 0; b < width; ++b)
    for (int a = 0; a < width; ++a) *out++ = std::size_t(cell) + std::size_t(b * grid.nx + a);
}

bool GridGeometry::find(double x, double y, std::int32_t& cell, double& xi, double& eta, int velocity_field) const {
  double s = (x - domain.origin.x()) * per_hx, t = (y - domain.origin.y()) * per_hy;
  if (!(s >= -round_off && t >= -round_off && s <= domain.nx - 1 + round_off && t <= domain.ny - 1 + round_off))
    return false;
  s = std::clamp(s, 0.0, double(domain.nx - 1));
  t = std::clamp(t, 0.0, double(domain.ny - 1));
  // With the ring, node i - 1 of the domain, the first of three, is node i of the grid.
  const int i = centred ? int(s + 0.5) : std::min(int(s), domain.nx - 2);
  const int j = centred ? int(t + 0.5) : std::min(int(t), domain.ny - 2);
  xi = s - i;
  eta = t - j;
  cell = std::int32_t(grid.node(i, j + velocity_field * field_rows));
  return true;
}

Vec2 GridGeometry::natural(const Particles& p, std::size_t k) const {
  const int i = p.cell[k] % grid.nx, j = p.cell[k] / grid.nx % field_rows;
  return {(p.x[k] - grid.origin.x()) * per_hx - (i + origin), (p.y[k] - grid.origin.y()) * per_hy - (j + origin)};
}

std::uint8_t GridGeometry::marks_of(std::int32_t cell, int row) const {
  const int i = cell - row * grid.nx, j = velocity_fields == 1 ? row : row % field_rows;
  const bool edge = centred && (i == 0 || j == 0 || i == grid.nx - width || j == field_grid.ny - width);
  return std::uint8_t(walls_of(cell) | (edge ? at_edge : 0) | (any_moved(moved_in(cell)) ? wall_moved : 0));
}

void GridGeometry::weights_at(std::int32_t cell, double xi, double eta, std::size_t* at, double* weights) const {
  const unsigned beside = walls_of(cell);
  const MovedNodes* by = moved_in(cell);
  stencil_nodes(cell, at);
  Shapes::with(shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr double half = 0.25;
    const auto lx = line_of<S>(xi, half, beside & wall_left, beside & wall_right, by, 0);
    const auto ly = line_of<S>(eta, half, beside & wall_down, beside & wall_up, by, 1);
    for (int c = 0; c < S::width * S::width; ++c) weights[c] = lx.w[c % S::width] * ly.w[c / S::width];
  });
}

}  // namespace pivnp::mpm

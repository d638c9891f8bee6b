// The one grid that measurement, tracking and simulation share: regular in the world, y upward.
#pragma once

#include <cstddef>

#include "pivnp/core/math.hpp"

namespace pivnp {

/// Node (i, j) lies at origin + (i hx, j hy); flat index j*nx + i; node arrays are [ny][nx]. An element (cell) carries
/// the index of its lower left node, (nx-1) x (ny-1) of them, flat index j*(nx-1) + i.
struct Grid {
  Vec2 origin = Vec2::Zero();   // position of node (0, 0), length unit of the record
  Vec2 spacing = Vec2::Ones();  // (hx, hy) > 0, length unit of the record
  int nx = 0;                   // nodes along x
  int ny = 0;                   // nodes along y

  std::size_t node_count() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  std::size_t element_count() const { return nx < 2 || ny < 2 ? 0 : std::size_t(nx - 1) * std::size_t(ny - 1); }
  std::size_t node(int i, int j) const { return std::size_t(j) * std::size_t(nx) + std::size_t(i); }
  std::size_t element(int i, int j) const { return std::size_t(j) * std::size_t(nx - 1) + std::size_t(i); }
  Vec2 position(int i, int j) const { return {origin.x() + i * spacing.x(), origin.y() + j * spacing.y()}; }
  Vec2 upper() const { return position(nx - 1, ny - 1); }
  bool operator==(const Grid& other) const {
    return origin == other.origin && spacing == other.spacing && nx == other.nx && ny == other.ny;
  }
};

/// A point inside an element: lower left node (i, j) and natural coordinates (xi, eta) in [0, 1].
struct ElementPoint {
  int i = 0, j = 0;
  double xi = 0, eta = 0;
};

/// Finds the element that holds `x`. Points on the grid's border, and up to 1e-9 spacings outside it (round-off), are
/// inside. Returns false, `point` untouched, for anything further out or not finite.
bool locate(const Grid& grid, const Vec2& x, ElementPoint& point);

/// A padded grid with `cells` more cells on every side; node (i, j) of `grid` is node (i + cells, j + cells) of it.
Grid padded(const Grid& grid, int cells);

/// The grid with every cell split into `factor` x `factor`; node (i, j) is node (factor i, factor j) of it.
Grid refined(const Grid& grid, int factor);

}  // namespace pivnp

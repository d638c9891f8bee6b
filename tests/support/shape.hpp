// Shape functions on the grid: the weights by which nodal values reach a point, and their gradients.
#pragma once

#include <array>

#include "pivnp/core/grid/grid.hpp"

namespace pivnp {

/// Bilinear weights of the four nodes of an element, in the order (i,j), (i+1,j), (i,j+1), (i+1,j+1).
/// N = 1/4 (1 + xi xi_j)(1 + eta eta_j) of the thesis' equation 2.3 (as corrected), written for [0, 1].
struct BilinearWeights {
  std::array<double, 4> value;  // sums to 1
  std::array<double, 4> dx;     // per length, sums to 0
  std::array<double, 4> dy;
};

inline BilinearWeights bilinear(const Grid& grid, const ElementPoint& p) {
  const double x0 = 1 - p.xi, x1 = p.xi, y0 = 1 - p.eta, y1 = p.eta;
  const double gx = 1 / grid.spacing.x(), gy = 1 / grid.spacing.y();
  return {{x0 * y0, x1 * y0, x0 * y1, x1 * y1},
          {-y0 * gx, y0 * gx, -y1 * gx, y1 * gx},
          {-x0 * gy, -x1 * gy, x0 * gy, x1 * gy}};
}

/// Flat indices of the same four nodes.
inline std::array<std::size_t, 4> bilinear_nodes(const Grid& grid, const ElementPoint& p) {
  const std::size_t n = grid.node(p.i, p.j);
  return {n, n + 1, n + std::size_t(grid.nx), n + std::size_t(grid.nx) + 1};
}

}  // namespace pivnp

// Conjugate gradients on the nodes, in lanes: the sums of a part of the nodes at a time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pivnp::mpm {

/// diagonal x - sum over edges of along times x beyond = ..., symmetric. `inverse`: of the diagonal; 0 where x is 0. By node.
struct PoreSystem {
  double *along_x, *along_y;  // of the edges to the right and up
  double *diagonal, *inverse, *solution, *residual, *direction, *product;
  std::ptrdiff_t row;
};

/// The product of matrix and direction; returns direction times product.
double product_lanes(const PoreSystem& s, const std::uint32_t* nodes, std::size_t size);
/// Adds `step` of the direction to the solution; returns residual times inverse times residual.
double advance_lanes(const PoreSystem& s, double step, const std::uint32_t* nodes, std::size_t size);
/// direction = inverse times residual + share of the direction.
void turn_lanes(const PoreSystem& s, double share, const std::uint32_t* nodes, std::size_t size);

}  // namespace pivnp::mpm

// Coefficients of the B-spline that passes through given values.
#pragma once

#include <array>
#include <vector>

namespace pivnp::np {

/// Coefficients, with one ghost on every side: [ny + 2][nx + 2], of the tensor spline of `degree` (2 or 3) through
/// `values` [ny][nx], nx, ny > degree. At the ends the coefficients go on as a polynomial of the spline's own degree
/// (for the cubic this is the not-a-knot condition; de Boor 1978), so that polynomials of that degree are repeated
/// exactly and the order holds up to the border. (Mirrored ends, usual for images, would force the slope to zero
/// there.)
std::vector<std::array<double, 2>> interpolate(int degree, int nx, int ny,
                                               const std::vector<std::array<double, 2>>& values);

/// Sum of w^2 of the weights that the nodal values themselves have at the fraction of a place whose spline
/// weights are `w` (first to last), far from the ends.
struct WeightSums {
  double square = 0;
};
WeightSums cardinal_sums(int degree, const double* w);

}  // namespace pivnp::np

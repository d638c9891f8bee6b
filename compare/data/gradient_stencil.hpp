// The gradient of a field known at scattered points, as weights on its values.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// Vectors g_j with grad f(0) = sum_j g_j (f_j - f(0)): least squares of a polynomial of second degree through f(0),
/// the neighbours at `to` weighted with 1/|to|^4 (the inverse-distance fit of Franke & Nielson 1980). Exact to the
/// second degree. Empty if the neighbours (none at zero) do not hold such a polynomial.
std::vector<Vec2> gradient_stencil(const std::vector<Vec2>& to);

}  // namespace pivnp::compare

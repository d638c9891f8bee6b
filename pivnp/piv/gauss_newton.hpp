// Method "gn": Gauss-Newton on dense shared warps, the field smoothed by as much as its own noise allows.
#pragma once

#include <memory>

#include "pivnp/piv/method.hpp"

namespace pivnp::piv {

std::unique_ptr<Method> make_gauss_newton(const PivOptions& options, const NodeLattice& nodes, int width, int height,
                                          int threads);

}  // namespace pivnp::piv

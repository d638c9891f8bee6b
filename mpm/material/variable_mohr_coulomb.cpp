#include "mpm/material/variable_mohr_coulomb.hpp"

#include <cmath>
#include <numbers>

#include "mpm/material/mohr_coulomb.hpp"

namespace pivnp::mpm {

namespace {

constexpr double degrees = 180 / std::numbers::pi;

}  // namespace

void VariableMohrCoulomb::update(const StressBatch& batch) const {
  for (std::size_t k = 0; k < batch.size; ++k) {
    const double pressure = -(batch.xx[k] + batch.yy[k] + batch.zz[k]) / (3 * batch.J[k]);
    const Strength s = strength_.at(batch.plastic_dev[k], pressure);
    const MohrCoulomb law(elastic_, s.friction * degrees, std::asin(s.sin_dilatancy) * degrees, s.cohesion, tension_);
    law.update(batch.part(k, 1));
  }
}

}  // namespace pivnp::mpm

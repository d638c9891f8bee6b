#include "mpm/material/variable_mohr_coulomb.hpp"

#include "mpm/material/lanes.hpp"
#include "mpm/material/mohr_coulomb.hpp"

namespace pivnp::mpm {

void VariableMohrCoulomb::update(const StressBatch& batch) const {
  const auto lanes = [&](const StressBatch& part, std::uint32_t* rare) {
    return changing_cone_lanes(elastic_, strength_.constants(), tension_, part.plastic_dev, part, rare);
  };
  update_in_lanes(batch, lanes, [&](std::size_t k) {
    if (MohrCoulomb::stays_open(elastic_, batch, k)) return;
    const double pressure = -(batch.xx[k] + batch.yy[k] + batch.zz[k]) / (3 * batch.J[k]);
    MohrCoulomb(elastic_, strength_.at(batch.plastic_dev[k], pressure), tension_).update_point(batch, k);
  });
}

}  // namespace pivnp::mpm

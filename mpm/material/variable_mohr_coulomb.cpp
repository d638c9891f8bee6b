#include "mpm/material/variable_mohr_coulomb.hpp"

#include "mpm/material/lanes.hpp"
#include "mpm/material/mohr_coulomb.hpp"

namespace pivnp::mpm {

void VariableMohrCoulomb::update(const StressBatch& batch) const {
  const auto lanes = [&](const StressBatch& part, std::uint32_t* rare) {
    const double* history = part.softened_by ? part.softened_by : part.plastic_dev;
    return changing_cone_lanes(elastic_, strength_.constants(), tension_, history, part, rare);
  };
  update_in_lanes(batch, lanes, [&](std::size_t k) {
    if (MohrCoulomb::stays_open(elastic_, batch, k)) return;
    const double pressure = -(batch.xx[k] + batch.yy[k] + batch.zz[k]) / (3 * batch.J[k]);
    const double history = batch.softened_by ? batch.softened_by[k] : batch.plastic_dev[k];
    MohrCoulomb(elastic_, strength_.at(history, pressure), tension_).update_point(batch, k);
  });
}

}  // namespace pivnp::mpm

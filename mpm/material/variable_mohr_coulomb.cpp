#include "mpm/material/variable_mohr_coulomb.hpp"

#include "mpm/material/lanes.hpp"
#include "mpm/material/mohr_coulomb.hpp"

namespace pivnp::mpm {

void VariableMohrCoulomb::update(const StressBatch& batch) const {
  const auto lanes = [&](const StressBatch& part, std::uint32_t* rare) {
    const double* history = part.softened_by ? part.softened_by : part.plastic_dev;
    return changing_cone_lanes(elastic_, strength_.constants(), tension_, history, part, rare);
  };
  update_in_lanes(batch, lanes, [&](const StressBatch& b, std::size_t k) {
    if (MohrCoulomb::stays_open(elastic_, b, k)) return;
    const double pressure = -(b.xx[k] + b.yy[k] + b.zz[k]) / (3 * b.J[k]);
    const double history = b.softened_by ? b.softened_by[k] : b.plastic_dev[k];
    MohrCoulomb(elastic_, strength_.at(history, pressure), tension_).update_point(b, k);
  });
}

}  // namespace pivnp::mpm

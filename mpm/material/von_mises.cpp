#include "mpm/material/von_mises.hpp"

#include <cmath>
#include <numbers>

namespace pivnp::mpm {

MaterialModel von_mises_model() {
  return {.name = "von_mises",
          .text = "perfect plasticity with one strength in shear",
          .keys = {{"shear_strength_pa", true}},
          .history = {plastic_strain, plastic_work},
          .make = [](const MaterialOptions& o, double) -> std::unique_ptr<Material> {
            return std::make_unique<VonMises>(Elastic(o.young_pa, o.poisson), o.shear_strength_pa);
          },
          .reduce = [](MaterialOptions& o, double factor) { o.shear_strength_pa /= factor; }};
}

void VonMises::update(const StressBatch& batch) const {
  for (std::size_t k = 0; k < batch.size; ++k) {
    Stress s = elastic_trial(elastic_, batch, k);
    const double mean = (s.xx + s.yy + s.zz) / 3;
    const double dxx = s.xx - mean, dyy = s.yy - mean, dzz = s.zz - mean;
    const double root_j2 = std::sqrt(0.5 * (dxx * dxx + dyy * dyy + dzz * dzz) + s.xy * s.xy);
    const double limit = strength_ * batch.J[k];
    if (root_j2 > limit) {
      const double keep = limit / root_j2;
      s = {mean + keep * dxx, mean + keep * dyy, mean + keep * dzz, keep * s.xy};
      // Plastic strain (root_j2 - limit)/(2G) s/root_j2, whose sqrt(2/3 e:e) is 2/sqrt(3) times sqrt(J2) of it.
      const double amount = (root_j2 - limit) / (2 * elastic_.shear);
      batch.history[plastic::strain][k] += 2 / std::numbers::sqrt3 * amount;
      batch.history[plastic::work][k] += 2 * limit * amount;
    }
    store(batch, k, s);
  }
}

}  // namespace pivnp::mpm

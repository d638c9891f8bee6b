#include "mpm/material/neo_hookean.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

namespace {

struct LeftCauchyGreen {
  double xx, yy, zz, xy, log_J;
};

LeftCauchyGreen averaged(const StressBatch& s, std::size_t k) {
  const double a = s.F_xx[k], b = s.F_xy[k], c = s.F_yx[k], d = s.F_yy[k];
  const double scale = std::pow(s.J[k] / (a * d - b * c), 2.0 / 3);
  return {scale * (a * a + b * b), scale * (c * c + d * d), scale, scale * (a * c + b * d), std::log(s.J[k])};
}

}  // namespace

void NeoHookean::update(const StressBatch& batch) const {
  const double mu = elastic_.shear;
  for (std::size_t k = 0; k < batch.size; ++k) {
    const LeftCauchyGreen b = averaged(batch, k);
    const double pressure = elastic_.lambda * b.log_J;
    store(batch, k, {mu * (b.xx - 1) + pressure, mu * (b.yy - 1) + pressure, mu * (b.zz - 1) + pressure, mu * b.xy});
  }
}

double NeoHookean::energy(const StressBatch& batch, std::size_t k) const {
  const LeftCauchyGreen b = averaged(batch, k);
  return 0.5 * elastic_.shear * (b.xx + b.yy + b.zz - 3) - elastic_.shear * b.log_J +
         0.5 * elastic_.lambda * b.log_J * b.log_J;
}

double NeoHookean::stiffness(const StressBatch& batch) const {
  // J times the spatial modulus along a direction n, with the stress: lambda + 2 (mu - lambda ln J) + tau_nn.
  double greatest = elastic_.p_wave_modulus();
  for (std::size_t k = 0; k < batch.size; ++k) {
    const double stress = std::max(batch.xx[k], batch.yy[k]) + std::abs(batch.xy[k]);
    greatest = std::max(greatest, elastic_.p_wave_modulus() - 2 * elastic_.lambda * std::log(batch.J[k]) + stress);
  }
  return greatest;
}

}  // namespace pivnp::mpm

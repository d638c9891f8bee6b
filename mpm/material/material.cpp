#include "mpm/material/material.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::mpm {

double Material::stiffness(const StressBatch& batch) const {
  // A tension adds its own stiffness (geometric); the bound on the greatest principal stress is enough.
  constexpr std::size_t apart = 8;  // greatest values that do not wait for one another
  std::array<double, apart> greatest{};
  const auto take = [&](std::size_t k, double& most) {
    most = std::max(most, std::max(batch.xx[k], batch.yy[k]) + std::abs(batch.xy[k]));
  };
  const std::size_t whole = batch.size / apart * apart;
  for (std::size_t k = 0; k < whole; k += apart)
    for (std::size_t l = 0; l < apart; ++l) take(k + l, greatest[l]);
  for (std::size_t k = whole; k < batch.size; ++k) take(k, greatest[0]);
  return elastic_.p_wave_modulus() + *std::max_element(greatest.begin(), greatest.end());
}

}  // namespace pivnp::mpm

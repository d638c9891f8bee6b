// Isotropic linear elasticity on the logarithmic strain (Hencky): tau = lambda tr(e) I + 2 mu e, e = 1/2 ln b. The
// stress is the only state: with f = V R the step, b = exp(2 C^-1 tau) becomes V R b R^T V. Path-independent.
#pragma once

#include "mpm/material/material.hpp"

namespace pivnp::mpm {

class LinearElastic final : public Material {
 public:
  using Material::Material;
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
};

}  // namespace pivnp::mpm

// Isotropic linear elasticity: Jaumann rate of the Kirchhoff stress = C : D. Isotropic C makes U = 1/2 tau:C^-1:tau its
// potential along any path, rotation included; for small elastic strains it is Hencky's law to second order.
#pragma once

#include "mpm/material/material.hpp"

namespace pivnp::mpm {

class LinearElastic final : public Material {
 public:
  using Material::Material;
  void update(const StressBatch& batch) const override;
};

}  // namespace pivnp::mpm

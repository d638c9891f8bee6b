// Elastic laws.
//
// linear_elastic: isotropic linear elasticity on the logarithmic strain (Hencky): tau = lambda tr(e) I + 2 mu e,
// e = 1/2 ln b. The stress is the only state: with f = V R the step, b = exp(2 C^-1 tau) becomes V R b R^T V.
// Path-independent.
// neo_hookean: compressible neo-Hookean solid: tau = mu (b - I) + lambda ln J I (Simo & Pister 1984; Bonet & Wood 2008,
// eq. 6.28), stored energy mu/2 (tr b - 3) - mu ln J + lambda/2 (ln J)^2. Where the volume is averaged (F-bar), F is
// scaled by (J averaged / det F)^(1/3) (de Souza Neto et al. 1996). From F, so it knows no stress at the start.
#pragma once

#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel linear_elastic_model();
MaterialModel neo_hookean_model();

class LinearElastic final : public Material {
 public:
  using Material::Material;
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
};

class NeoHookean final : public Material {
 public:
  using Material::Material;
  void update(const StressBatch& batch) const override;
  double energy(const StressBatch& batch, std::size_t k) const override;
  double stiffness(const StressBatch& batch) const override;
  bool from_deformation() const override { return true; }
};

}  // namespace pivnp::mpm

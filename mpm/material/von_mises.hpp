// Perfect plasticity of von Mises: sqrt(J2) <= k, k the strength in pure shear; radial return (Wilkins 1964).
// In plane strain at failure k equals the undrained strength s_u of a Tresca soil.
#pragma once

#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel von_mises_model();

class VonMises final : public Material {
 public:
  VonMises(const Elastic& elastic, double shear_strength_pa) : Material(elastic), strength_(shear_strength_pa) {}
  void update(const StressBatch& batch) const override;

 private:
  double strength_;
};

}  // namespace pivnp::mpm

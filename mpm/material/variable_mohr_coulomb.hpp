// The closed-form Mohr-Coulomb of mohr_coulomb.hpp with a strength that changes (strength.hpp): every point is returned
// with the strength of its history and pressure before the step. Explicit: the strength lags by one step, which is of
// the order of the step's plastic strain times the rate of softening.
#pragma once

#include "mpm/material/material.hpp"
#include "mpm/material/strength.hpp"

namespace pivnp::mpm {

class VariableMohrCoulomb final : public Material {
 public:
  VariableMohrCoulomb(const Elastic& elastic, const StrengthLaw& strength, double tension_pa)
      : Material(elastic), strength_(strength), tension_(tension_pa) {}
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
  double nonlocal_length() const override { return strength_.nonlocal_length(); }

 private:
  StrengthLaw strength_;
  double tension_;
};

}  // namespace pivnp::mpm

// Water as a material of its own: a reservoir, a lake, a dam break.
//
// The pressure is a function of the volume alone, Kirchhoff's p = -K ln J, and never a tension: beyond the volume at
// which the pressure is zero the point stands open (opening_strain keeps by how much, in ln J), carries nothing, and
// presses again only once that volume is closed. The path through it does not matter, so a splash leaves no volume behind.
// Deviatoric stress is Newton's, 2 eta dev(d), and depends on nothing before the step: distortion adds up to nothing.
// During the initial equilibrium, whose steps have no time, a shear modulus of a millionth of K keeps points from drifting.
#pragma once

#include "mpm/material/model.hpp"

namespace pivnp::mpm {

MaterialModel water_model();

class Water final : public Material {
 public:
  /// `density_kg_m3` and `cell_m`: for the step that viscosity allows.
  Water(double bulk_pa, double viscosity_pa_s, double density_kg_m3, double cell_m);
  void update(const StressBatch& batch) const override;
  bool takes_places() const override { return true; }
  double energy(const StressBatch& batch, std::size_t k) const override;
  double stiffness(const StressBatch& batch) const override;

 private:
  double bulk_, viscosity_, stiffness_;
};

}  // namespace pivnp::mpm

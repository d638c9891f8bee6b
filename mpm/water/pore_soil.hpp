// What of a material the water sees.
#pragma once

#include <string>
#include <vector>

#include "mpm/material/options.hpp"
#include "mpm/water/options.hpp"

namespace pivnp::mpm {

/// Permeability is what a laboratory measures under this gravity, whatever gravity acts in the simulation.
inline constexpr double laboratory_gravity = 9.81;  // m/s^2

struct PoreSoil {
  double porosity = 0;       // at the start; 0: no pores
  double mobility = 0;       // K/(rho_w g_laboratory) at the start, m^2/(Pa s)
  bool kozeny_carman = false;
  double grain_density = 0;  // kg/m^3
  double collapse = 0;       // volumetric strain as the pores fill
  double bulk_modulus = 0;   // of the skeleton, Pa; where it collapses
  double constrained_modulus = 0;  // of the skeleton, Pa; where the water follows a level
  bool drained = false;      // never another pressure than the hydrostatic one

  bool has_pores() const { return porosity > 0; }
  bool holds_water() const { return has_pores() && !drained; }
  double mobility_at(double n) const {
    if (!kozeny_carman) return mobility;
    const double ratio = n / porosity, grains = (1 - porosity) / (1 - n);
    return mobility * ratio * ratio * ratio * grains * grains;
  }
  /// Mass of the grains in a unit of initial volume.
  double dry_density() const { return (1 - porosity) * grain_density; }
};

/// What is wrong with the density of the grains beside that of the water; empty: nothing.
std::string fault_of_grains(const MaterialOptions& m, const WaterOptions& water);

/// Of materials that check_material() accepts. Throws InputError naming material.<name>.<key> where [water] lacks.
PoreSoil pore_soil(const MaterialOptions& material, const std::string& name, const WaterOptions* water);
/// The material as a dry law sees it, with the density of grains and water together.
MaterialOptions without_pores(MaterialOptions material, const WaterOptions& water);

}  // namespace pivnp::mpm

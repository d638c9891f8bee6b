// What of a material heat sees.
#pragma once

#include <string>

#include "mpm/material/material.hpp"
#include "mpm/material/options.hpp"
#include "mpm/water/options.hpp"
#include "mpm/water/water_properties.hpp"

namespace pivnp::mpm {

/// Do bands of the material exchange with their surroundings by Alvarado 2018, (4.25) to (4.34)?
inline bool exchanges_as_printed(const MaterialOptions& m) {
  return m.band_thickness_m && m.band_exchange == BandExchange::printed;
}

/// Capacities and expansions are those at the start: porosity changes by thousandths where heat matters.
struct HeatSoil {
  double capacity = 0;      // of a unit of initial volume, J/(m^3 K)
  double conductivity = 0;  // W/(m K)
  double swelling = 0;      // of the water and the grains in the pores, n beta_w + (1 - n) beta_s, 1/K; 0 without water
  double skeleton = 0;      // thermal expansion of the skeleton's volume, 1/K
  // Of embedded bands.
  double band = 0;          // thickness, m; 0: none
  BandExchange exchange = BandExchange::deviation;
  double storage = 0;       // of the band, m + n/K_w, 1/Pa; 0 without water
  double unloaded = 0;      // n/K_w alone, 1/Pa
  double mobility = 0;      // K/gamma, m^2/(Pa s)
  double carried = 0;       // capacity of the water that flows, J/(m^3 K)
  double cell = 0;          // side of the cells, m
  double spread = 0;        // of what a zone one cell wide swells by, the share that the smoothed strain of the pores takes out of it
  // Of water whose properties follow its temperature.
  bool by_temperature = false;
  double porosity = 0, grains = 0;  // expansion of the grains in a unit of initial volume, 1/K
  double reference_c = 0;           // at which permeability and density are given, degC

  /// Side of the cells, and what they do to a zone.
  void take_cells(double side_m);
  double diffusivity() const { return conductivity / capacity; }
  /// What heats the band's water into pressure: the skeleton's own growth makes room.
  double pressurising() const { return swelling - skeleton; }
  /// Volume by which water and grains in a unit of initial volume swell between two temperatures.
  double swells(double from_c, double to_c) const {
    if (!by_temperature) return swelling * (to_c - from_c);
    return porosity * water_density(reference_c) * (1 / water_density(to_c) - 1 / water_density(from_c)) + grains * (to_c - from_c);
  }
  double mobility_at(double celsius) const {
    return by_temperature ? mobility * water_viscosity(reference_c) / water_viscosity(celsius) : mobility;
  }
};

/// Of materials that check_material() accepts. `water`: null without. Throws InputError naming material.<name>.<key>.
HeatSoil heat_soil(const MaterialOptions& material, const std::string& name, const WaterOptions* water, double initial_c);
/// Throws InputError naming material.<name>.<key> where heat's keys are given without [heat].
void refuse_heat_keys(const MaterialOptions& material, const std::string& name);

}  // namespace pivnp::mpm

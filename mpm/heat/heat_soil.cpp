#include "mpm/heat/heat_soil.hpp"

#include <cmath>
#include <numbers>

#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

HeatSoil heat_soil(const MaterialOptions& m, const std::string& name, const WaterOptions* water, double initial_c) {
  const std::string key = "material." + name + ".";
  if (!m.grain_specific_heat_j_kg_k)
    throw InputError(key + "grain_specific_heat_j_kg_k: missing beside [heat]; expected more than 0 (J/(kg K))");
  if (!m.conductivity_w_m_k) throw InputError(key + "conductivity_w_m_k: missing beside [heat]; expected 0 or more (W/(m K))");
  if (m.density_end_kg_m3) throw InputError(key + "density_end_kg_m3: given beside [heat], expected none");
  HeatSoil soil;
  const double n = m.porosity.value_or(0), grains = m.porosity ? (1 - n) * m.grain_density_kg_m3 : m.density_kg_m3;
  soil.capacity = grains * *m.grain_specific_heat_j_kg_k;
  soil.conductivity = *m.conductivity_w_m_k;
  soil.skeleton = m.skeleton_thermal_expansion_1_k.value_or(m.grain_thermal_expansion_1_k);
  if (m.band_thickness_m) soil.band = *m.band_thickness_m;
  if (!m.band_thickness_m && m.band_compressibility_1_pa) throw InputError(key + "band_compressibility_1_pa: given without band_thickness_m, expected both or neither");
  soil.exchange = m.band_exchange;
  if (!m.porosity || !water) return soil;
  soil.capacity += n * water->density_kg_m3 * water->specific_heat_j_kg_k;
  if (m.drained) return soil;
  soil.swelling = n * water->thermal_expansion_1_k + (1 - n) * m.grain_thermal_expansion_1_k;
  const Elastic elastic(m.young_pa, m.poisson);
  soil.unloaded = n / water->bulk_modulus_pa;
  soil.storage = m.band_compressibility_1_pa.value_or(1 / elastic.p_wave_modulus()) + soil.unloaded;
  soil.mobility = m.permeability_m_s.value_or(0) / (water->density_kg_m3 * laboratory_gravity);
  soil.carried = water->density_kg_m3 * water->specific_heat_j_kg_k;
  soil.by_temperature = water->properties == WaterProperties::by_temperature;
  soil.porosity = n;
  soil.grains = (1 - n) * m.grain_thermal_expansion_1_k;
  soil.reference_c = initial_c;
  return soil;
}

// The pressure p of rows of cells that swell by s and give way by m p: p = (K_w/n) Q (s - m p), Q = c^2 (2 - (1 + 3 c)/4 c) for rows that
// alternate by the angle a each, c = cos^2(a/2) (the smoothed strain of the pores, four points a cell). Of one row's s the share
// (mean over a of (1 + r) Q/(1 + r Q)), r = m K_w/n, makes pressure in it.
void HeatSoil::take_cells(double side_m) {
  cell = side_m;
  if (!(storage > 0 && unloaded > 0)) return;
  constexpr int angles = 256;
  const double r = storage / unloaded - 1;
  double kept = 0;
  for (int k = 0; k < angles; ++k) {
    const double c = std::pow(std::cos(std::numbers::pi * (k + 0.5) / (2 * angles)), 2), q = c * c * (2 - 0.25 * (1 + 3 * c) * c);
    kept += (1 + r) * q / (1 + r * q) / angles;
  }
  spread = 1 - kept;
}

void refuse_heat_keys(const MaterialOptions& m, const std::string& name) {
  const char* given = m.grain_thermal_expansion_1_k != 0       ? "grain_thermal_expansion_1_k"
                      : m.skeleton_thermal_expansion_1_k       ? "skeleton_thermal_expansion_1_k"
                      : m.grain_specific_heat_j_kg_k           ? "grain_specific_heat_j_kg_k"
                      : m.conductivity_w_m_k                   ? "conductivity_w_m_k"
                      : m.band_thickness_m                     ? "band_thickness_m"
                      : m.band_compressibility_1_pa            ? "band_compressibility_1_pa"
                      : m.band_exchange != BandExchange::deviation ? "band_exchange"
                                                               : nullptr;
  if (given) throw InputError("material." + name + "." + given + ": given without [heat], expected both or neither");
}

}  // namespace pivnp::mpm

#include "mpm/water/pore_soil.hpp"

#include <sstream>

#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

std::string fault_of_grains(const MaterialOptions& m, const WaterOptions& water) {
  if (!m.porosity || m.grain_density_kg_m3 > water.density_kg_m3) return {};
  std::ostringstream text;
  text << "found " << m.grain_density_kg_m3 << ", expected more than water.density_kg_m3, " << water.density_kg_m3 << " (lighter grains float)";
  return text.str();
}

PoreSoil pore_soil(const MaterialOptions& m, const std::string& name, const WaterOptions* water) {
  PoreSoil soil;
  if (!m.porosity) return soil;
  if (!water) throw InputError("material." + name + ".porosity: given without [water], expected both or neither");
  if (const std::string fault = fault_of_grains(m, *water); !fault.empty()) throw InputError("material." + name + ".grain_density_kg_m3: " + fault);
  soil.porosity = *m.porosity;
  soil.mobility = m.permeability_m_s.value_or(0) / (water->density_kg_m3 * laboratory_gravity);
  soil.kozeny_carman = m.permeability == PermeabilityLaw::kozeny_carman;
  soil.grain_density = m.grain_density_kg_m3;
  soil.drained = m.drained;
  soil.collapse = m.wetting_collapse;
  return soil;
}

MaterialOptions without_pores(MaterialOptions m, const WaterOptions& water) {
  if (!m.porosity) return m;
  m.density_kg_m3 = (1 - *m.porosity) * m.grain_density_kg_m3 + *m.porosity * water.density_kg_m3;
  m.porosity = std::nullopt;
  m.permeability_m_s = std::nullopt;
  m.permeability = PermeabilityLaw::constant;
  m.drained = false;
  m.wetting_collapse = 0;
  return m;
}

}  // namespace pivnp::mpm

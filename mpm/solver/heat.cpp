// Heat: where a step hands over to it, and what it refuses.
#include "mpm/solver/impl.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr double boiling_c = 100;

}  // namespace

std::vector<HeatSoil> take_heat(const MpmOptions& options, const Scene& scene) {
  std::vector<HeatSoil> soils;
  if (!scene.heat) refuse_heat_keys(scene.boundaries);
  for (std::size_t k = 0; k < scene.materials.size(); ++k) {
    const auto& names = scene.particles.label_names;
    const std::string name = k < names.size() ? names[k] : std::to_string(k);
    if (!scene.heat) refuse_heat_keys(scene.materials[k], name);
    else soils.push_back(heat_soil(scene.materials[k], name, scene.water ? &*scene.water : nullptr, scene.heat->initial_c));
  }
  const bool by_temperature = scene.water && scene.water->properties == WaterProperties::by_temperature;
  if (by_temperature && !scene.heat) throw InputError("water.properties: found 'temperature' without [heat], expected both or 'constant'");
  if (by_temperature && scene.water->thermal_expansion_1_k != WaterOptions{}.thermal_expansion_1_k)
    throw InputError("water.thermal_expansion_1_k: given beside water.properties = \"temperature\", expected one of them");
  if (!scene.heat) return soils;
  if (options.sleep_below_m_s) throw InputError("mpm.sleep_below_m_s: given beside [heat], expected none: heat also flows in material at rest");
  if (!scene.water) return soils;
  const char* level = scene.water->level_m ? ".level_m" : !scene.water->level_history.empty() ? ".level_history" : nullptr;
  if (level && scene.water->groundwater != Groundwater::level)
    throw InputError(std::string("water") + level + ": given beside [heat], expected water.groundwater = \"level\" with it: all pores are full");
  for (const auto& [name, b] : scene.boundaries)
    if (b.water_level_m) throw InputError("boundary." + name + ".water_level_m: given beside [heat], expected pressure_pa: all pores are full");
  return soils;
}

void Solver::Impl::start_heat() {
  if (!scene.heat) return;
  heat = std::make_unique<Heat>(*scene.heat, warm, scene.particles, materials, g, HeatBoundaries(scene.boundaries, restraints.walls()), restraints.tied());
  if (!scene.temperature0.empty() && scene.temperature0.size() != p.size()) throw InputError("mpm: temperature0 needs one entry a particle, or none");
  heat->start(p, state.heat, scene.temperature0);
  if (water) water->take_reference_temperature(p, scene.heat->initial_c);
}

void Solver::Impl::heat_points(const Cycle& c) {
  if (heat)
    count(heat->step(p, g, materials, water.get(), state.heat, state.balance.darcy, c.gravity, state.time, c.dt,
                     heat_due, c.threads));
}

void Solver::Impl::take_work() {
  if (heat) count(heat->take_work(p, materials, water.get(), state.heat, most_threads));
}

void Solver::Impl::count(const HeatSums& sums) {
  state.balance.heat_made += sums.made;
  state.balance.heat_inflow += sums.inflow;
  state.balance.bodies += sums.expansion;
  state.balance.moved += std::abs(sums.expansion);
}

// Of a point that ends.
void Solver::Impl::end_heat(std::size_t k) {
  const double pending = heat->pending(p, k);
  state.balance.heat_made += pending;
  state.balance.heat_inflow -= heat->contained(p, k) + pending;
}

void Solver::Impl::put_heat(MotionFrame& frame) const {
  const std::span<float> limit = frame.add("heat_limit", p.size());
  const bool banded = heat->any_bands();
  const std::span<float> temperature = banded ? frame.add("band_temperature", p.size()) : std::span<float>{};
  const std::span<float> pressure = banded && water ? frame.add("band_pressure", p.size()) : std::span<float>{};
  for (std::size_t k = 0; k < p.size(); ++k) {
    const std::uint32_t to = p.index[k];
    const Heat::InBand in = heat->in_band(p, state.heat, k);
    if (banded) temperature[to] = float(in.temperature);
    if (!pressure.empty()) pressure[to] = float(in.pressure);
    const double mean = -(p.tau_xx[k] + p.tau_yy[k] + p.tau_zz[k]) / (3 * p.J[k]) + (water ? p.pressure[k] : 0);
    limit[to] = float((in.temperature > boiling_c ? 1 : 0) + (water && in.pressure > std::max(0.0, mean) && in.pressure > p.pressure[k] ? 2 : 0));
  }
}

}  // namespace pivnp::mpm

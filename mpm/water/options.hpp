// What the water in the soil can be told.
#pragma once

#include <array>
#include <optional>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

/// How pore pressure is advanced.
enum class PressureScheme { in_steps, projected };
inline constexpr std::array pressure_scheme_names{NamedValue{"explicit", PressureScheme::in_steps},
                                                     NamedValue{"projected", PressureScheme::projected}};
constexpr const auto& names_of(PressureScheme) { return pressure_scheme_names; }

/// Pressure at time 0.
enum class WaterStart { hydrostatic, seepage, zero };
inline constexpr std::array water_start_names{NamedValue{"hydrostatic", WaterStart::hydrostatic}, NamedValue{"seepage", WaterStart::seepage},
                                              NamedValue{"zero", WaterStart::zero}};
constexpr const auto& names_of(WaterStart) { return water_start_names; }

/// What follows a level inside the material.
enum class Groundwater { flow, level };
inline constexpr std::array groundwater_names{NamedValue{"flow", Groundwater::flow}, NamedValue{"level", Groundwater::level}};
constexpr const auto& names_of(Groundwater) { return groundwater_names; }

/// What density, expansion and viscosity follow.
enum class WaterProperties { constant, by_temperature };
inline constexpr std::array water_properties_names{NamedValue{"constant", WaterProperties::constant},
                                                   NamedValue{"temperature", WaterProperties::by_temperature}};
constexpr const auto& names_of(WaterProperties) { return water_properties_names; }

struct WaterOptions {
  double density_kg_m3 = 1000;
  double bulk_modulus_pa = 2.2e9;
  std::optional<double> level_m;
  Points level_history;
  std::optional<WaterStart> start;
  Points surface_m;
  Groundwater groundwater = Groundwater::flow;
  bool inertia = false;
  WaterProperties properties = WaterProperties::constant;
  double thermal_expansion_1_k = 3.4e-4;
  double specific_heat_j_kg_k = 4186;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("density_kg_m3", self.density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "density without pressure", .min = 0, .above_min = true});
    visit("bulk_modulus_pa", self.bulk_modulus_pa, OptionInfo{.unit = "Pa", .text = "bulk modulus", .min = 0, .above_min = true});
    visit("level_m", self.level_m, OptionInfo{.unit = "m", .text = "height of the water's surface inside and outside; default: all pores full, p = 0 at the start"});
    visit("level_history", self.level_history, OptionInfo{.unit = "s, m", .text = "times and heights in place of level_m: inside at the start, later of the water outside"});
    visit("start", self.start, OptionInfo{.text = "pressure at time 0: hydrostatic, of steady seepage, or zero; default: hydrostatic if there is a level"});
    visit("surface_m", self.surface_m, OptionInfo{.unit = "m", .text = "the water's surface inside the material at time 0, from left to right; default: the level"});
    visit("groundwater", self.groundwater, OptionInfo{.text = "flow: the surface inside moves with the flow; level: it follows the level at once"});
    visit("inertia", self.inertia, OptionInfo{.text = "inertia of the flow (Biot's theory in full), for waves near n g/K; full pores, explicit pressure"});
    visit("properties", self.properties, OptionInfo{.text = "temperature: expansion (Kell 1975) and viscosity (IAPWS 2008) of water, 0 to 150 degC, with [heat]"});
    visit("thermal_expansion_1_k", self.thermal_expansion_1_k, OptionInfo{.unit = "1/K", .text = "thermal expansion of its volume", .min = 0, .max = 0.01});
    visit("specific_heat_j_kg_k", self.specific_heat_j_kg_k, OptionInfo{.unit = "J/(kg K)", .text = "specific heat", .min = 0, .above_min = true});
  }
};

}  // namespace pivnp::mpm

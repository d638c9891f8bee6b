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
    visit("level_m", self.level_m, OptionInfo{.unit = "m", .text = "height of the water's surface, inside the material and outside: at the start pressure is hydrostatic below it, and the material above it holds no water; the surface inside then moves with the flow, and pressure is nowhere below zero (left out: all pores are full and stay so, and pressure is zero at the start)"});
    visit("level_history", self.level_history, OptionInfo{.unit = "s, m", .text = "times and heights of that surface, linear between and constant beyond (in place of level_m): the first height holds inside the material too; later heights are those of the water outside, while the water inside flows"});
    visit("start", self.start, OptionInfo{.text = "pressure at time 0: hydrostatic, below the level or surface_m; seepage, that of steady flow under the pressures at the boundaries and the level, with its surface and seepage faces; zero, in full pores (left out: hydrostatic with a level or surface_m, else zero)"});
    visit("surface_m", self.surface_m, OptionInfo{.unit = "m", .text = "the water's surface inside the material at time 0, points x, y from left to right, linear between and level beyond: pressure is hydrostatic below it, and the material above holds no water (left out: at the level)"});
    visit("groundwater", self.groundwater, OptionInfo{.text = "flow: the water's surface inside the material moves with the flow; level: pores are full, above the level without pressure, and as the level changes, points gain or lose the water that changes their pressure, under constant total stress, as it changes the hydrostatic pressure of their place; excess pressure comes on top (ground whose water follows a reservoir over a time that is not simulated)"});
    visit("inertia", self.inertia, OptionInfo{.text = "the flow has its own inertia, in Darcy's law and in the motion of the mixture (Biot's theory in full): for waves of so high a frequency, about porosity times gravity over permeability, that water does not follow at once; with explicit pressure and one material whose pores are full"});
    visit("properties", self.properties, OptionInfo{.text = "constant: expansion, viscosity and so permeability do not depend on temperature; temperature: water expands as Kell (1975) has its density, and permeability changes with its viscosity (IAPWS 2008), from 0 to 150 degC, thermal_expansion_1_k is not used, and density_kg_m3 and the materials' permeability_m_s are those at heat.initial_c; with [heat]"});
    visit("thermal_expansion_1_k", self.thermal_expansion_1_k, OptionInfo{.unit = "1/K", .text = "thermal expansion of its volume, with [heat]", .min = 0, .max = 0.01});
    visit("specific_heat_j_kg_k", self.specific_heat_j_kg_k, OptionInfo{.unit = "J/(kg K)", .text = "specific heat, with [heat]", .min = 0, .above_min = true});
  }
};

}  // namespace pivnp::mpm

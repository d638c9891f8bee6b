// What a material can be told.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

/// The names of the laws that are listed (model.hpp).
std::vector<std::string> material_model_names();
/// A key that a law declares for itself (MaterialKey::own).
struct OwnMaterialKey {
  std::string_view name;
  OptionInfo info;
};
/// Those of all laws.
std::vector<OwnMaterialKey> own_material_keys();

/// What reduction_factor divides.
enum class ReductionOf { strength, cohesion };
inline constexpr std::array reduction_of_names{NamedValue{"strength", ReductionOf::strength}, NamedValue{"cohesion", ReductionOf::cohesion}};
constexpr const auto& names_of(ReductionOf) { return reduction_of_names; }

/// The greatest number that is less.
inline constexpr double below_one = 1 - std::numeric_limits<double>::epsilon() / 2;

/// How permeability follows porosity: not at all, or K n^3/(1 - n)^2 over what that is at the start.
enum class PermeabilityLaw { constant, kozeny_carman };
inline constexpr std::array permeability_law_names{NamedValue{"constant", PermeabilityLaw::constant},
                                                   NamedValue{"kozeny_carman", PermeabilityLaw::kozeny_carman}};
constexpr const auto& names_of(PermeabilityLaw) { return permeability_law_names; }

/// How softening_length_m regularises (strength.hpp).
enum class SofteningAverage { smeared, nonlocal };
inline constexpr std::array softening_average_names{NamedValue{"smeared", SofteningAverage::smeared},
                                                    NamedValue{"nonlocal", SofteningAverage::nonlocal}};
constexpr const auto& names_of(SofteningAverage) { return softening_average_names; }

/// What an embedded band of a point that yields exchanges with its surroundings (heat/bands.hpp).
enum class BandExchange { deviation, printed, none };
inline constexpr std::array band_exchange_names{NamedValue{"deviation", BandExchange::deviation}, NamedValue{"printed", BandExchange::printed},
                                                NamedValue{"none", BandExchange::none}};
constexpr const auto& names_of(BandExchange) { return band_exchange_names; }

struct MaterialOptions {
  std::string model = "mohr_coulomb";
  double density_kg_m3 = 0;
  double young_pa = 0;
  double poisson = 0.3;
  double friction_deg = 0;
  double dilatancy_deg = 0;
  double cohesion_pa = 0;
  double tension_pa = 0;
  double shear_strength_pa = 0;
  std::optional<double> friction_residual_deg;
  std::optional<double> cohesion_residual_pa;
  double softening_shape = 0;
  std::optional<double> softening_length_m;
  SofteningAverage softening_average = SofteningAverage::smeared;
  std::optional<double> friction_low_stress_deg;
  std::optional<double> friction_half_pa;
  std::optional<double> dilatancy_fade;
  double apex_pa = 10;
  std::optional<double> friction_flow_deg;
  double inertial_number = 0.279;
  double grain_diameter_m = 0;
  double grain_density_kg_m3 = 2650;
  double bulk_pa = 0;
  std::optional<double> density_end_kg_m3;
  double density_from_s = 0;
  std::optional<double> density_until_s;
  std::optional<double> reduction_factor;
  double reduction_from_s = 0;
  std::optional<double> reduction_until_s;
  ReductionOf reduction_of = ReductionOf::strength;
  std::optional<double> removed_s;
  std::optional<double> porosity;
  std::optional<double> permeability_m_s;
  PermeabilityLaw permeability = PermeabilityLaw::constant;
  bool drained = false;
  double wetting_collapse = 0;
  double grain_thermal_expansion_1_k = 0;
  std::optional<double> skeleton_thermal_expansion_1_k;
  std::optional<double> grain_specific_heat_j_kg_k;
  std::optional<double> conductivity_w_m_k;
  std::optional<double> band_thickness_m;
  std::optional<double> band_compressibility_1_pa;
  BandExchange band_exchange = BandExchange::deviation;
  std::map<std::string, std::optional<double>, std::less<>> own;  // by own_material_keys(); what is not there is not given

  /// Of a key of a law's own.
  const std::optional<double>& own_value(std::string_view key) const {
    static const std::optional<double> none;
    const auto at = own.find(key);
    return at == own.end() ? none : at->second;
  }
  std::optional<double>& own_value(std::string_view key) { return own[std::string(key)]; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("model", self.model,
          OptionInfo{.text = "constitutive law", .names = &material_model_names});
    visit("density_kg_m3", self.density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "bulk density (not with porosity)", .min = 0, .above_min = true});
    visit("young_pa", self.young_pa, OptionInfo{.unit = "Pa", .text = "Young's modulus", .min = 0, .above_min = true});
    visit("poisson", self.poisson, OptionInfo{.text = "Poisson's ratio", .min = 0, .max = 0.499});
    visit("friction_deg", self.friction_deg, OptionInfo{.unit = "deg", .text = "peak friction angle", .min = 0, .max = 89});
    visit("dilatancy_deg", self.dilatancy_deg, OptionInfo{.unit = "deg", .text = "dilatancy angle", .min = 0, .max = 89});
    visit("cohesion_pa", self.cohesion_pa, OptionInfo{.unit = "Pa", .text = "peak cohesion", .min = 0});
    visit("tension_pa", self.tension_pa, OptionInfo{.unit = "Pa", .text = "tension limit: principal stress (mohr_coulomb) or mean stress, at most the apex", .min = 0});
    visit("shear_strength_pa", self.shear_strength_pa,
          OptionInfo{.unit = "Pa", .text = "undrained shear strength, in pure shear or half the greatest stress difference", .min = 0});
    visit("friction_residual_deg", self.friction_residual_deg, OptionInfo{.unit = "deg", .text = "friction angle after softening; default: none", .min = 0, .max = 89});
    visit("cohesion_residual_pa", self.cohesion_residual_pa, OptionInfo{.unit = "Pa", .text = "cohesion after softening; default: none", .min = 0});
    visit("softening_shape", self.softening_shape, OptionInfo{.text = "eta in exp(-eta e), e the accumulated plastic deviatoric strain", .min = 0});
    visit("softening_length_m", self.softening_length_m, OptionInfo{.unit = "m", .text = "smeared: band width l, eta h/l with cells h; nonlocal: l in the weights exp(-r^2/l^2); default: eta", .min = 0, .above_min = true});
    visit("softening_average", self.softening_average, OptionInfo{.text = "regularised by the cells' size, or by the average A around each point, 2 A - e"});
    visit("friction_low_stress_deg", self.friction_low_stress_deg, OptionInfo{.unit = "deg", .text = "friction angle at zero pressure; friction_deg is then that at large pressure", .min = 0, .max = 89});
    visit("friction_half_pa", self.friction_half_pa, OptionInfo{.unit = "Pa", .text = "mean pressure at which the angle is half-way between", .min = 0, .above_min = true});
    visit("dilatancy_fade", self.dilatancy_fade, OptionInfo{.text = "plastic deviatoric strain over which dilatancy falls to 1/e; default: constant", .min = 0, .above_min = true});
    visit("apex_pa", self.apex_pa, OptionInfo{.unit = "Pa", .text = "least distance of the cone's apex from zero stress", .min = 0, .above_min = true});
    visit("friction_flow_deg", self.friction_flow_deg, OptionInfo{.unit = "deg", .text = "friction angle in rapid flow; friction_deg is that at rest", .min = 0, .max = 89});
    visit("inertial_number", self.inertial_number, OptionInfo{.text = "I0 at which friction is half-way", .min = 0, .above_min = true});
    visit("grain_diameter_m", self.grain_diameter_m, OptionInfo{.unit = "m", .text = "mean grain diameter", .min = 0});
    visit("grain_density_kg_m3", self.grain_density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "density of the grains, with porosity", .min = 0, .above_min = true});
    visit("bulk_pa", self.bulk_pa, OptionInfo{.unit = "Pa", .text = "bulk modulus K; sqrt(K/density) of ten times the greatest speed will do", .min = 0});
    visit("density_end_kg_m3", self.density_end_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "density to which it changes in time; default: constant", .min = 0, .above_min = true});
    visit("density_from_s", self.density_from_s, OptionInfo{.unit = "s", .text = "start of the change", .min = 0});
    visit("density_until_s", self.density_until_s, OptionInfo{.unit = "s", .text = "its end", .min = 0, .above_min = true});
    visit("reduction_factor", self.reduction_factor, OptionInfo{.text = "divisor of cohesion and tan(friction) in time", .min = 0, .above_min = true});
    visit("reduction_from_s", self.reduction_from_s, OptionInfo{.unit = "s", .text = "start of the reduction", .min = 0});
    visit("reduction_until_s", self.reduction_until_s, OptionInfo{.unit = "s", .text = "its end; default: at once", .min = 0});
    visit("reduction_of", self.reduction_of, OptionInfo{.text = "all that has strength, or cohesion alone"});
    visit("removed_s", self.removed_s, OptionInfo{.unit = "s", .text = "time at which the material is excavated; default: never", .min = 0, .above_min = true});
    visit("porosity", self.porosity, OptionInfo{.text = "pores over total volume, filled by [water]; default: no water", .min = 0, .max = below_one, .above_min = true});
    visit("permeability_m_s", self.permeability_m_s, OptionInfo{.unit = "m/s", .text = "hydraulic conductivity, at 9.81 m/s^2", .min = 0});
    visit("permeability", self.permeability, OptionInfo{.text = "kozeny_carman: in proportion to n^3/(1 - n)^2, n the porosity"});
    visit("drained", self.drained, OptionInfo{.text = "pore pressure is always hydrostatic below water.level_m (zero without a level)"});
    visit("wetting_collapse", self.wetting_collapse, OptionInfo{.text = "volumetric strain of the unloaded skeleton as its pores fill for the first time", .min = 0, .max = 0.5});
    visit("grain_thermal_expansion_1_k", self.grain_thermal_expansion_1_k, OptionInfo{.unit = "1/K", .text = "thermal expansion of the grains' volume", .min = 0, .max = 0.01});
    visit("skeleton_thermal_expansion_1_k", self.skeleton_thermal_expansion_1_k, OptionInfo{.unit = "1/K", .text = "that of the skeleton; default: that of the grains (Alvarado 2018: 0)", .min = 0, .max = 0.01});
    visit("grain_specific_heat_j_kg_k", self.grain_specific_heat_j_kg_k, OptionInfo{.unit = "J/(kg K)", .text = "specific heat of the grains", .min = 0, .above_min = true});
    visit("conductivity_w_m_k", self.conductivity_w_m_k, OptionInfo{.unit = "W/(m K)", .text = "thermal conductivity of grains and water together", .min = 0});
    visit("band_thickness_m", self.band_thickness_m, OptionInfo{.unit = "m", .text = "thickness of the shear band that takes all plastic work as heat; default: no bands", .min = 0, .above_min = true});
    visit("band_compressibility_1_pa", self.band_compressibility_1_pa, OptionInfo{.unit = "1/Pa", .text = "its one-dimensional compressibility; default: that of the elastic skeleton", .min = 0});
    visit("band_exchange", self.band_exchange, OptionInfo{.text = "deviation: over the width of the localised zone; printed: (4.25) to (4.34) of Alvarado 2018; none"});
    for (const OwnMaterialKey& key : own_material_keys()) visit(key.name, self.own_value(key.name), key.info);
  }
};

}  // namespace pivnp::mpm

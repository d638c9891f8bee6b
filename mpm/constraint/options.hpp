// What restraints, contact and rigid bodies can be told.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mpm/constraint/motion_table.hpp"
#include "pivnp/core/choice.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

enum class BoundaryType : std::uint8_t { fixed, roller, frictional, absorbing, traction, tied };
inline constexpr std::array boundary_type_names{
    NamedValue{"fixed", BoundaryType::fixed},         NamedValue{"roller", BoundaryType::roller},
    NamedValue{"frictional", BoundaryType::frictional}, NamedValue{"absorbing", BoundaryType::absorbing},
    NamedValue{"traction", BoundaryType::traction},   NamedValue{"tied", BoundaryType::tied}};
constexpr const auto& names_of(BoundaryType) { return boundary_type_names; }

/// A restraint on nodes: along a line (within half a cell of it), or inside a polygon.
struct BoundaryOptions {
  Points line_m;
  Points polygon_m;
  BoundaryType type = BoundaryType::fixed;
  std::optional<Pair> normal;
  double friction = 0;
  std::optional<double> until_s;
  std::optional<Pair> velocity_m_s;
  std::string motion;
  MotionTable motion_table;  // of that file
  bool grips = false;        // it moves, and follows the material that it holds (RigidBodies::grip()): set by the solver
  std::optional<Pair> withdraw_m_s;
  double withdraw_from_s = 0;
  std::optional<Pair> traction_pa;
  bool follows_face = false;
  double rise_s = 0;
  std::optional<Pair> across_m;
  std::optional<double> pressure_pa;
  std::optional<double> water_level_m;
  bool drained = false;
  std::optional<double> flux_m_s;
  std::optional<double> temperature_c;
  std::optional<double> heat_flux_w_m2;
  std::optional<double> heat_transfer_w_m2_k;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("line_m", self.line_m, OptionInfo{.unit = "m", .text = "two end points; holds nodes within half a cell"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "holds the nodes inside"});
    visit("type", self.type,
          OptionInfo{.text = "roller: no normal motion; frictional: may slide and separate; absorbing: lets waves out; traction: a load; tied: moves as the opposite side"});
    visit("normal", self.normal, OptionInfo{.text = "out of the material; default: across the line"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient (frictional)", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "time at which it is removed; default: never"});
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity of the boundary and the material it holds (fixed, roller)"});
    visit("motion", self.motion, OptionInfo{.text = "in place of velocity_m_s: CSV as body.NAME.motion"});
    visit("withdraw_m_s", self.withdraw_m_s, OptionInfo{.unit = "m/s", .text = "velocity of withdrawal: nodes are free once the line has passed them"});
    visit("withdraw_from_s", self.withdraw_from_s, OptionInfo{.unit = "s", .text = "start of the withdrawal", .min = 0});
    visit("traction_pa", self.traction_pa, OptionInfo{.unit = "Pa", .text = "load on the face (x, y) per length at time 0 (traction)"});
    visit("follows_face", self.follows_face, OptionInfo{.text = "the traction turns with the face and acts on its present length"});
    visit("rise_s", self.rise_s, OptionInfo{.unit = "s", .text = "time over which the traction rises from 0 (0: at once)", .min = 0});
    visit("across_m", self.across_m, OptionInfo{.unit = "m", .text = "from line_m to the opposite side (tied)"});
    visit("pressure_pa", self.pressure_pa, OptionInfo{.unit = "Pa", .text = "pore pressure there; without it, drained or flux_m_s: impervious"});
    visit("water_level_m", self.water_level_m, OptionInfo{.unit = "m", .text = "level of the water outside: hydrostatic below, a seepage face above"});
    visit("drained", self.drained, OptionInfo{.text = "pore pressure there is zero, or that of the water outside"});
    visit("flux_m_s", self.flux_m_s, OptionInfo{.unit = "m/s", .text = "inflow, volume per area and time (negative: outflow)"});
    visit("temperature_c", self.temperature_c, OptionInfo{.unit = "degC", .text = "temperature there, or beyond the wall with heat_transfer_w_m2_k; default: insulated"});
    visit("heat_flux_w_m2", self.heat_flux_w_m2, OptionInfo{.unit = "W/m^2", .text = "heat that enters there"});
    visit("heat_transfer_w_m2_k", self.heat_transfer_w_m2_k, OptionInfo{.unit = "W/(m^2 K)", .text = "heat transfer coefficient (convection)", .min = 0});
  }
};

/// How bodies of the simulated material meet: each list of regions is one body.
struct ContactOptions {
  std::vector<std::string> regions;
  std::vector<std::string> against;
  std::optional<double> friction;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("regions", self.regions, OptionInfo{.text = "names of the regions of one body"});
    visit("against", self.against, OptionInfo{.text = "those of the other; default: all other regions"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient; default: rough, no slip while pressed", .min = 0});
  }
};

/// A rigid body with prescribed motion, or free with a mass.
struct RigidOptions {
  std::vector<double> circle_m;
  Points polygon_m;
  Pair velocity_m_s = {0.0, 0.0};
  std::optional<double> friction;
  double from_s = 0;
  std::optional<double> until_s;
  std::optional<double> mass_kg_m;
  std::optional<double> mass_end_kg_m;
  double mass_from_s = 0;
  std::optional<double> mass_until_s;
  bool turns = true;
  double angular_velocity_rad_s = 0;
  std::optional<Pair> pivot_m;
  std::string motion;
  MotionTable motion_table;  // of that file
  std::string force;
  ForceTable force_table;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("circle_m", self.circle_m, OptionInfo{.unit = "m", .text = "centre x, y and radius"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "outline at time 0"});
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity (x, y); of a free body that at time 0"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient; default: rough", .min = 0});
    visit("from_s", self.from_s, OptionInfo{.unit = "s", .text = "moves from this time on", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "stops at this time; default: never"});
    visit("mass_kg_m", self.mass_kg_m, OptionInfo{.unit = "kg/m", .text = "mass per metre of thickness of a free body; default: prescribed motion", .min = 0, .above_min = true});
    visit("mass_end_kg_m", self.mass_end_kg_m, OptionInfo{.unit = "kg/m", .text = "mass to which it changes in time; default: constant", .min = 0, .above_min = true});
    visit("mass_from_s", self.mass_from_s, OptionInfo{.unit = "s", .text = "start of the change", .min = 0});
    visit("mass_until_s", self.mass_until_s, OptionInfo{.unit = "s", .text = "its end", .min = 0, .above_min = true});
    visit("turns", self.turns, OptionInfo{.text = "a free body may rotate"});
    visit("angular_velocity_rad_s", self.angular_velocity_rad_s, OptionInfo{.unit = "rad/s", .text = "prescribed rotation about pivot_m, anticlockwise"});
    visit("pivot_m", self.pivot_m, OptionInfo{.unit = "m", .text = "centre of rotation at time 0; it moves with the body; default: the centroid"});
    visit("motion", self.motion, OptionInfo{.text = "CSV: time_s and some of displacement_x_m, displacement_y_m, velocity_x_m_s, velocity_y_m_s, angle_rad, angular_velocity_rad_s (or mm, deg, min ...)"});
    visit("force", self.force, OptionInfo{.text = "CSV of forces on a free body: time_s, force_x_n_m, force_y_n_m (or kn_m), per metre of thickness"});
  }
};

}  // namespace pivnp::mpm

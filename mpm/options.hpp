// What a simulation can be told: material, scheme, boundaries, bodies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

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

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("model", self.model,
          OptionInfo{.text = "constitutive law", .choices = {"linear_elastic", "neo_hookean", "von_mises", "tresca", "mohr_coulomb"}});
    visit("density_kg_m3", self.density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "bulk density", .min = 0, .above_min = true});
    visit("young_pa", self.young_pa, OptionInfo{.unit = "Pa", .text = "Young's modulus", .min = 0, .above_min = true});
    visit("poisson", self.poisson, OptionInfo{.text = "Poisson's ratio", .min = 0, .max = 0.499});
    visit("friction_deg", self.friction_deg, OptionInfo{.unit = "deg", .text = "friction angle (mohr_coulomb)", .min = 0, .max = 89});
    visit("dilatancy_deg", self.dilatancy_deg, OptionInfo{.unit = "deg", .text = "dilatancy angle (mohr_coulomb)", .min = 0, .max = 89});
    visit("cohesion_pa", self.cohesion_pa, OptionInfo{.unit = "Pa", .text = "cohesion (mohr_coulomb)", .min = 0});
    visit("tension_pa", self.tension_pa, OptionInfo{.unit = "Pa", .text = "greatest tension carried (mohr_coulomb; never past the apex)", .min = 0});
    visit("shear_strength_pa", self.shear_strength_pa,
          OptionInfo{.unit = "Pa", .text = "undrained shear strength s_u: strength in pure shear (von_mises), half the greatest stress difference (tresca)", .min = 0});
  }
};

struct MpmOptions {
  std::string scheme = "default";
  int per_element = 4;
  Pair gravity_m_s2 = {0.0, -9.81};
  bool settle = true;
  double settle_damping = 0.7;
  double settle_tolerance = 1e-3;
  std::optional<std::string> shape;
  std::optional<std::string> transfer;
  std::optional<std::string> stress_update;
  std::optional<std::string> locking;
  std::optional<double> damping;
  std::optional<double> pic_per_s;
  int xpic_order = 5;
  double courant = 0.4;
  double energy_limit = 0.25;
  bool end_at_rest = true;
  int refine = 1;
  std::optional<double> end_s;
  std::optional<double> output_rate_hz;
  Points domain_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("scheme", self.scheme, OptionInfo{.text = "set of numerical choices", .choices = {"default", "geopart"}});
    visit("per_element", self.per_element, OptionInfo{.text = "material points per occupied element: 1, 4, 9 ...", .min = 1, .max = 100});
    visit("gravity_m_s2", self.gravity_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity (x, y)"});
    visit("settle", self.settle, OptionInfo{.text = "bring the weight on quasi-statically, damped, before time 0 (strains and displacements then start at zero)"});
    visit("settle_damping", self.settle_damping, OptionInfo{.text = "local damping while settling", .min = 0, .max = 1});
    visit("settle_tolerance", self.settle_tolerance, OptionInfo{.text = "settled when unbalanced over applied force falls below this", .min = 0, .above_min = true});
    visit("shape", self.shape, OptionInfo{.text = "shape functions (left out: by the scheme)", .choices = {"bilinear", "gimp", "bspline"}});
    visit("transfer", self.transfer, OptionInfo{.text = "velocity transfer (left out: by the scheme)", .choices = {"flip", "apic", "xpic"}});
    visit("stress_update", self.stress_update, OptionInfo{.text = "when stress is updated: last with velocities mapped again, last, or first (left out: by the scheme)", .choices = {"musl", "usl", "usf"}});
    visit("locking", self.locking, OptionInfo{.text = "against volumetric locking (left out: by the scheme; selective and full: bilinear only)", .choices = {"none", "selective", "full", "fbar"}});
    visit("damping", self.damping, OptionInfo{.text = "Cundall's local damping during the run (left out: 0; geopart: 0.05)", .min = 0, .max = 1});
    visit("pic_per_s", self.pic_per_s, OptionInfo{.unit = "1/s", .text = "rate at which flip turns into PIC: a share 1 - exp(-rate dt) a step (left out: 0)", .min = 0});
    visit("xpic_order", self.xpic_order, OptionInfo{.text = "order of xpic: 1 is PIC, higher ones filter less", .min = 1, .max = 20});
    visit("courant", self.courant, OptionInfo{.text = "time step over the critical one", .min = 0, .max = 1, .above_min = true});
    visit("energy_limit", self.energy_limit, OptionInfo{.text = "the run stops when the energy residual passes this share of what was turned over", .min = 0, .above_min = true});
    visit("end_at_rest", self.end_at_rest, OptionInfo{.text = "stop stepping once motion has ended; the states that follow repeat the last one"});
    visit("refine", self.refine, OptionInfo{.text = "cells per measured element and side", .min = 1, .max = 16});
    visit("end_s", self.end_s, OptionInfo{.unit = "s", .text = "end of the simulation (left out: the last frame)", .min = 0, .above_min = true});
    visit("output_rate_hz", self.output_rate_hz, OptionInfo{.unit = "Hz", .text = "states written per second (left out: at the frames' times)", .min = 0, .above_min = true});
    visit("domain_m", self.domain_m, OptionInfo{.unit = "m", .text = "lower left and upper right corner that the simulation may use (left out: the measured grid)"});
  }
};

/// A restraint on nodes: along a line (within half a cell of it), or inside a polygon.
struct BoundaryOptions {
  Points line_m;
  Points polygon_m;
  std::string type = "fixed";
  std::optional<Pair> normal;
  double friction = 0;
  std::optional<double> until_s;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("line_m", self.line_m, OptionInfo{.unit = "m", .text = "two end points; nodes within half a cell are restrained"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "nodes inside are restrained"});
    visit("type", self.type,
          OptionInfo{.text = "fixed: no motion; roller: none along the normal; frictional: a wall that pushes, and rubs; absorbing: lets waves out", .choices = {"fixed", "roller", "frictional", "absorbing"}});
    visit("normal", self.normal, OptionInfo{.text = "direction out of the material (left out: across the line, away from the material)"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient (frictional)", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "removed at this time (a gate; left out: stays)"});
  }
};

/// A rigid body with prescribed motion.
struct RigidOptions {
  std::vector<double> circle_m;
  Points polygon_m;
  Pair velocity_m_s = {0.0, 0.0};
  std::optional<double> friction;
  double from_s = 0;
  std::optional<double> until_s;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("circle_m", self.circle_m, OptionInfo{.unit = "m", .text = "centre x, y and radius"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "outline at time 0"});
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity (x, y)"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient; 0 is smooth (left out: rough, material sticks to it)", .min = 0});
    visit("from_s", self.from_s, OptionInfo{.unit = "s", .text = "moves from this time on", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "stops at this time (left out: never)"});
  }
};

}  // namespace pivnp::mpm

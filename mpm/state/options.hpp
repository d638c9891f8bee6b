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
  std::optional<double> friction_residual_deg;
  std::optional<double> cohesion_residual_pa;
  double softening_shape = 0;
  std::optional<double> softening_length_m;
  std::string softening_average = "smeared";
  std::optional<double> friction_low_stress_deg;
  std::optional<double> friction_half_pa;
  std::optional<double> dilatancy_fade;
  double apex_pa = 10;
  std::optional<double> friction_flow_deg;
  double inertial_number = 0.279;
  double grain_diameter_m = 0;
  double grain_density_kg_m3 = 2650;
  double bulk_pa = 0;
  double shear_pa = 0;
  std::optional<double> density_end_kg_m3;
  double density_from_s = 0;
  std::optional<double> density_until_s;
  std::optional<double> reduction_factor;
  double reduction_from_s = 0;
  std::optional<double> reduction_until_s;
  std::optional<double> removed_s;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("model", self.model,
          OptionInfo{.text = "constitutive law", .choices = {"linear_elastic", "neo_hookean", "von_mises", "tresca", "mohr_coulomb", "mohr_coulomb_smooth", "drucker_prager", "mu_i", "water"}});
    visit("density_kg_m3", self.density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "bulk density", .min = 0, .above_min = true});
    visit("young_pa", self.young_pa, OptionInfo{.unit = "Pa", .text = "Young's modulus (left out with water)", .min = 0, .above_min = true});
    visit("poisson", self.poisson, OptionInfo{.text = "Poisson's ratio", .min = 0, .max = 0.499});
    visit("friction_deg", self.friction_deg, OptionInfo{.unit = "deg", .text = "friction angle, at its peak (mohr_coulomb, mohr_coulomb_smooth, drucker_prager, mu_i)", .min = 0, .max = 89});
    visit("dilatancy_deg", self.dilatancy_deg, OptionInfo{.unit = "deg", .text = "dilatancy angle (mohr_coulomb, mohr_coulomb_smooth, drucker_prager)", .min = 0, .max = 89});
    visit("cohesion_pa", self.cohesion_pa, OptionInfo{.unit = "Pa", .text = "cohesion, at its peak (mohr_coulomb, mohr_coulomb_smooth, drucker_prager)", .min = 0});
    visit("tension_pa", self.tension_pa, OptionInfo{.unit = "Pa", .text = "greatest tension carried, a principal stress with mohr_coulomb, else the mean stress (never past the apex)", .min = 0});
    visit("shear_strength_pa", self.shear_strength_pa,
          OptionInfo{.unit = "Pa", .text = "undrained shear strength s_u: strength in pure shear (von_mises), half the greatest stress difference (tresca)", .min = 0});
    visit("friction_residual_deg", self.friction_residual_deg, OptionInfo{.unit = "deg", .text = "friction angle after softening (both mohr_coulomb; left out: none)", .min = 0, .max = 89});
    visit("cohesion_residual_pa", self.cohesion_residual_pa, OptionInfo{.unit = "Pa", .text = "cohesion after softening (both mohr_coulomb; left out: none)", .min = 0});
    visit("softening_shape", self.softening_shape, OptionInfo{.text = "eta: strength falls as exp(-eta times the accumulated plastic deviatoric strain)", .min = 0});
    visit("softening_length_m", self.softening_length_m, OptionInfo{.unit = "m", .text = "smeared: width of the band for which softening_shape holds; with cells of side h the rate is softening_shape h over it (left out: softening_shape, whatever the cells). nonlocal: length l of the weights exp(-r^2/l^2), at least a cell", .min = 0, .above_min = true});
    visit("softening_average", self.softening_average, OptionInfo{.text = "how softening_length_m regularises: by the cells' size (smeared), or by the average of the plastic strain around each point, 2 average - own (nonlocal)", .choices = {"smeared", "nonlocal"}});
    visit("friction_low_stress_deg", self.friction_low_stress_deg, OptionInfo{.unit = "deg", .text = "friction angle without confinement, friction_deg being that at large pressure (both mohr_coulomb; left out: one angle)", .min = 0, .max = 89});
    visit("friction_half_pa", self.friction_half_pa, OptionInfo{.unit = "Pa", .text = "mean pressure at which the angle is half-way between the two", .min = 0, .above_min = true});
    visit("dilatancy_fade", self.dilatancy_fade, OptionInfo{.text = "accumulated plastic deviatoric strain over which dilatancy falls to 1/e (both mohr_coulomb; left out: it stays)", .min = 0, .above_min = true});
    visit("apex_pa", self.apex_pa, OptionInfo{.unit = "Pa", .text = "least distance of the cone's apex from zero stress (mohr_coulomb_smooth)", .min = 0, .above_min = true});
    visit("friction_flow_deg", self.friction_flow_deg, OptionInfo{.unit = "deg", .text = "friction angle in rapid flow, friction_deg being that at rest (mu_i)", .min = 0, .max = 89});
    visit("inertial_number", self.inertial_number, OptionInfo{.text = "I0 at which friction is half-way (mu_i)", .min = 0, .above_min = true});
    visit("grain_diameter_m", self.grain_diameter_m, OptionInfo{.unit = "m", .text = "mean grain diameter (mu_i)", .min = 0});
    visit("grain_density_kg_m3", self.grain_density_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "density of the grains (mu_i)", .min = 0, .above_min = true});
    visit("bulk_pa", self.bulk_pa, OptionInfo{.unit = "Pa", .text = "bulk modulus (water)", .min = 0});
    visit("shear_pa", self.shear_pa, OptionInfo{.unit = "Pa", .text = "shear modulus, small against bulk_pa (water; 0: a millionth of it)", .min = 0});
    visit("density_end_kg_m3", self.density_end_kg_m3, OptionInfo{.unit = "kg/m^3", .text = "density to which it rises or falls in time (left out: it stays)", .min = 0, .above_min = true});
    visit("density_from_s", self.density_from_s, OptionInfo{.unit = "s", .text = "start of that change", .min = 0});
    visit("density_until_s", self.density_until_s, OptionInfo{.unit = "s", .text = "its end; linear between", .min = 0, .above_min = true});
    visit("reduction_factor", self.reduction_factor, OptionInfo{.text = "cohesion and tan(friction) are divided by it in time (left out: they stay)", .min = 0, .above_min = true});
    visit("reduction_from_s", self.reduction_from_s, OptionInfo{.unit = "s", .text = "start of that change", .min = 0});
    visit("reduction_until_s", self.reduction_until_s, OptionInfo{.unit = "s", .text = "its end; linear between (left out: at once)", .min = 0});
    visit("removed_s", self.removed_s, OptionInfo{.unit = "s", .text = "taken out at this time, as in an excavation; one region a stage (left out: stays)", .min = 0, .above_min = true});
  }
};

struct MpmOptions {
  std::string scheme = "default";
  int per_element = 4;
  Pair gravity_m_s2 = {0.0, -9.81};
  std::optional<Pair> gravity_from_m_s2;
  std::optional<double> gravity_ramp_s;
  bool settle = true;
  std::optional<double> k0;
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
  std::optional<double> sleep_below_m_s;
  std::optional<double> end_displacement_m;
  int refine = 1;
  std::optional<double> end_s;
  std::optional<double> output_rate_hz;
  Points domain_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("scheme", self.scheme, OptionInfo{.text = "set of numerical choices", .choices = {"default", "geopart"}});
    visit("per_element", self.per_element, OptionInfo{.text = "material points per occupied element: 1, 4, 9 ...", .min = 1, .max = 100});
    visit("gravity_m_s2", self.gravity_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity (x, y)"});
    visit("gravity_from_m_s2", self.gravity_from_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity at time 0, where it changes (a centrifuge spinning up); settling is under this one"});
    visit("gravity_ramp_s", self.gravity_ramp_s, OptionInfo{.unit = "s", .text = "time at which gravity_m_s2 is reached, linearly", .min = 0, .above_min = true});
    visit("settle", self.settle, OptionInfo{.text = "bring the weight on quasi-statically, damped, before time 0 (strains and displacements then start at zero)"});
    visit("k0", self.k0, OptionInfo{.text = "horizontal over vertical stress at the start: the stress at time 0 without settle, the first guess with it (left out: none; poisson/(1 - poisson))", .min = 0, .max = 10});
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
    visit("sleep_below_m_s", self.sleep_below_m_s, OptionInfo{.unit = "m/s", .text = "blocks of cells in which nothing moves half as fast are not stepped until something faster reaches them; what that leaves out is bounded and noted (not beside a [contact.NAME] or tied sides; left out: nothing sleeps)", .min = 0, .above_min = true});
    visit("end_displacement_m", self.end_displacement_m, OptionInfo{.unit = "m", .text = "stop stepping once a particle or free body has moved this far, looked at every hundred steps (left out: never); the states that follow repeat the last one", .min = 0, .above_min = true});
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
  std::optional<Pair> velocity_m_s;
  std::optional<Pair> withdraw_m_s;
  double withdraw_from_s = 0;
  std::optional<Pair> traction_pa;
  double rise_s = 0;
  std::optional<Pair> across_m;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("line_m", self.line_m, OptionInfo{.unit = "m", .text = "two end points; nodes within half a cell are restrained"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "nodes inside are restrained"});
    visit("type", self.type,
          OptionInfo{.text = "fixed: no motion; roller: none along the normal; frictional: a wall that pushes, and rubs; absorbing: lets waves out; traction: a load on the material's face along line_m; tied: nodes move as those of the opposite side, across_m away (a laminar box, or a piece of an endless slope; not beside a [contact.NAME])", .choices = {"fixed", "roller", "frictional", "absorbing", "traction", "tied"}});
    visit("normal", self.normal, OptionInfo{.text = "direction out of the material (left out: across the line, away from the material)"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient (frictional)", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "removed at this time (a gate; left out: stays)"});
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity given to the nodes, which stay the same ones (fixed; left out: none)"});
    visit("withdraw_m_s", self.withdraw_m_s, OptionInfo{.unit = "m/s", .text = "velocity at which the line or polygon is drawn away: nodes are free once it has passed them (left out: it stays)"});
    visit("withdraw_from_s", self.withdraw_from_s, OptionInfo{.unit = "s", .text = "start of the withdrawal", .min = 0});
    visit("traction_pa", self.traction_pa, OptionInfo{.unit = "Pa", .text = "load on the face, x and y (traction); it moves with the particles next to the line"});
    visit("rise_s", self.rise_s, OptionInfo{.unit = "s", .text = "time over which the traction rises from 0 (0: at once)", .min = 0});
    visit("across_m", self.across_m, OptionInfo{.unit = "m", .text = "from line_m to the opposite side, x and y (tied)"});
  }
};

/// How bodies of the simulated material meet: each list of regions is one body.
struct ContactOptions {
  std::vector<std::string> regions;
  std::vector<std::string> against;
  std::optional<double> friction;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("regions", self.regions, OptionInfo{.text = "names of the regions that make up the body"});
    visit("against", self.against, OptionInfo{.text = "names of those that make up the other (left out: all other bodies; regions in no list are one)"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient; 0 is smooth (left out: rough, no slip while pressed)", .min = 0});
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

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("circle_m", self.circle_m, OptionInfo{.unit = "m", .text = "centre x, y and radius"});
    visit("polygon_m", self.polygon_m, OptionInfo{.unit = "m", .text = "outline at time 0"});
    visit("velocity_m_s", self.velocity_m_s, OptionInfo{.unit = "m/s", .text = "velocity (x, y)"});
    visit("friction", self.friction, OptionInfo{.text = "Coulomb coefficient; 0 is smooth (left out: rough, material sticks to it)", .min = 0});
    visit("from_s", self.from_s, OptionInfo{.unit = "s", .text = "moves from this time on", .min = 0});
    visit("until_s", self.until_s, OptionInfo{.unit = "s", .text = "stops at this time (left out: never)"});
    visit("mass_kg_m", self.mass_kg_m, OptionInfo{.unit = "kg/m", .text = "mass a metre of thickness: the body is free, velocity_m_s is that at time 0 (left out: its motion is prescribed)", .min = 0, .above_min = true});
    visit("mass_end_kg_m", self.mass_end_kg_m, OptionInfo{.unit = "kg/m", .text = "mass to which it rises or falls in time (left out: it stays)", .min = 0, .above_min = true});
    visit("mass_from_s", self.mass_from_s, OptionInfo{.unit = "s", .text = "start of that change", .min = 0});
    visit("mass_until_s", self.mass_until_s, OptionInfo{.unit = "s", .text = "its end; linear between", .min = 0, .above_min = true});
    visit("turns", self.turns, OptionInfo{.text = "a free body may turn"});
  }
};

}  // namespace pivnp::mpm

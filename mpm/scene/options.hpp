// What a simulation can be told as a whole.
#pragma once

#include <array>
#include <optional>

#include "mpm/state/scheme_rows.hpp"
#include "mpm/water/options.hpp"
#include "pivnp/core/options.hpp"

namespace pivnp::mpm {

/// What the plane of the simulation is.
enum class Geometry { plane, axisymmetric };
inline constexpr std::array geometry_names{NamedValue{"plane", Geometry::plane}, NamedValue{"axisymmetric", Geometry::axisymmetric}};
constexpr const auto& names_of(Geometry) { return geometry_names; }

struct MpmOptions {
  SchemeName scheme = SchemeName::standard;
  Geometry geometry = Geometry::plane;
  int per_element = 4;
  Pair gravity_m_s2 = {0.0, -9.81};
  std::optional<Pair> gravity_from_m_s2;
  std::optional<double> gravity_ramp_s;
  bool initial_equilibrium = true;
  std::optional<double> k0;
  double equilibrium_damping = 0.7;
  std::optional<double> equilibrium_tolerance;
  std::optional<ShapeKind> shape;
  std::optional<TransferKind> transfer;
  std::optional<StressUpdate> stress_update;
  std::optional<Locking> locking;
  std::optional<double> damping;
  std::optional<double> pic_per_s;
  int xpic_order = 5;
  std::optional<double> courant;
  double energy_limit = 0.25;
  bool end_at_rest = true;
  std::optional<double> sleep_below_m_s;
  std::optional<double> end_displacement_m;
  int refine = 1;
  std::optional<double> end_s;
  std::optional<double> output_rate_hz;
  Points domain_m;
  std::optional<PressureScheme> pressure;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("scheme", self.scheme, OptionInfo{.text = "set of numerical choices"});
    visit("geometry", self.geometry, OptionInfo{.text = "plane: plane strain, per metre of thickness; axisymmetric: x is the distance from the axis of symmetry, x = 0, along which y runs, and masses, forces and energies are those of one radian"});
    visit("per_element", self.per_element, OptionInfo{.text = "material points per occupied element: 1, 4, 9 ...", .min = 1, .max = 100});
    visit("gravity_m_s2", self.gravity_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity (x, y)"});
    visit("gravity_from_m_s2", self.gravity_from_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity at time 0, where it changes (a centrifuge spinning up); the initial equilibrium is found under this one"});
    visit("gravity_ramp_s", self.gravity_ramp_s, OptionInfo{.unit = "s", .text = "time at which gravity_m_s2 is reached, linearly", .min = 0, .above_min = true});
    visit("initial_equilibrium", self.initial_equilibrium, OptionInfo{.text = "apply the weight quasi-statically, with damping, before time 0 (strains and displacements then start at zero)", .alias = "settle"});
    visit("k0", self.k0, OptionInfo{.text = "horizontal over vertical stress at the start: the stress at time 0 without initial_equilibrium, the first guess with it (left out: none; poisson/(1 - poisson))", .min = 0, .max = 10});
    visit("equilibrium_damping", self.equilibrium_damping, OptionInfo{.text = "local damping while the initial equilibrium is sought", .min = 0, .max = 1, .alias = "settle_damping"});
    visit("equilibrium_tolerance", self.equilibrium_tolerance, OptionInfo{.text = "the equilibrium is found when the ratio of unbalanced to applied force falls below this (left out: 1e-3; beside [water] it is then sought on to 1e-7, as far as that comes in four times as many iterations, so that slopes in water at rest are at rest)", .min = 0, .above_min = true, .alias = "settle_tolerance"});
    visit("shape", self.shape, OptionInfo{.text = "shape functions (left out: by the scheme)"});
    visit("transfer", self.transfer, OptionInfo{.text = "velocity transfer (left out: by the scheme)"});
    visit("stress_update", self.stress_update, OptionInfo{.text = "when stress is updated: musl, last, with velocities mapped again; usl, last; usf, first (left out: by the scheme)"});
    visit("locking", self.locking, OptionInfo{.text = "averages against volumetric locking (left out: by the scheme; selective and full: bilinear only)"});
    visit("damping", self.damping, OptionInfo{.text = "Cundall's local damping during the run (left out: 0; the thesis' program has 0.05)", .min = 0, .max = 1});
    visit("pic_per_s", self.pic_per_s, OptionInfo{.unit = "1/s", .text = "rate of blending from flip or aflip to PIC: a share 1 - exp(-rate dt) per step (left out: flip 0, aflip 10 (g/h)^(1/2))", .min = 0});
    visit("xpic_order", self.xpic_order, OptionInfo{.text = "order of xpic: 1 is PIC, higher ones filter less", .min = 1, .max = 20});
    visit("courant", self.courant, OptionInfo{.text = "time step over h/(c + v), c the fastest wave, v the fastest point (left out: 0.4, which holds however points lie; with B-splines and aflip or apic, in the plane, without bodies, contact, water and damping, as long as their present arrangement allows, 0.8 at most)", .min = 0, .max = 1, .above_min = true});
    visit("energy_limit", self.energy_limit, OptionInfo{.text = "the run stops when the energy residual passes this share of the energy supplied", .min = 0, .above_min = true});
    visit("end_at_rest", self.end_at_rest, OptionInfo{.text = "stop stepping once motion has ended; the states that follow repeat the last one"});
    visit("sleep_below_m_s", self.sleep_below_m_s, OptionInfo{.unit = "m/s", .text = "blocks of cells in which nothing moves half as fast are not stepped until something faster reaches them; the error by this is bounded and noted; water in the pores flows on beside what moves, and wakes blocks whose pressure it changes (not beside a [contact.NAME] or tied sides; left out: nothing sleeps)", .min = 0, .above_min = true});
    visit("end_displacement_m", self.end_displacement_m, OptionInfo{.unit = "m", .text = "stop stepping once a particle or free body has moved this far, checked every hundred steps (left out: never); the states that follow repeat the last one", .min = 0, .above_min = true});
    visit("refine", self.refine, OptionInfo{.text = "cells per measured element and side", .min = 1, .max = 16});
    visit("end_s", self.end_s, OptionInfo{.unit = "s", .text = "end of the simulation (left out: the last frame)", .min = 0, .above_min = true});
    visit("output_rate_hz", self.output_rate_hz, OptionInfo{.unit = "Hz", .text = "states written per second (left out: at the frames' times)", .min = 0, .above_min = true});
    visit("domain_m", self.domain_m, OptionInfo{.unit = "m", .text = "lower left and upper right corner that the simulation may use (left out: the measured grid)"});
    visit("pressure", self.pressure, OptionInfo{.text = "how pore pressure is advanced, with [water]: explicit, in steps of water and flow (beside [heat] the flow takes parts of a step where it alone asks for shorter ones); projected, in steps of the skeleton's wave, found for all nodes together (left out: projected where it should be twice as fast and nothing speaks against it, else explicit; the notes give the reason)"});
  }
};

}  // namespace pivnp::mpm

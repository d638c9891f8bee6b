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
    visit("geometry", self.geometry, OptionInfo{.text = "plane strain, or axisymmetric: x is the radius, and masses and forces are per radian"});
    visit("per_element", self.per_element, OptionInfo{.text = "material points per occupied element: 1, 4, 9 ...", .min = 1, .max = 100});
    visit("gravity_m_s2", self.gravity_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity (x, y)"});
    visit("gravity_from_m_s2", self.gravity_from_m_s2, OptionInfo{.unit = "m/s^2", .text = "gravity at time 0, where it changes; the initial equilibrium is found under it"});
    visit("gravity_ramp_s", self.gravity_ramp_s, OptionInfo{.unit = "s", .text = "time at which gravity_m_s2 is reached, linearly", .min = 0, .above_min = true});
    visit("initial_equilibrium", self.initial_equilibrium, OptionInfo{.text = "find the stresses that balance the weight before time 0", .alias = "settle"});
    visit("k0", self.k0, OptionInfo{.text = "horizontal over vertical stress at the start, or first guess of the equilibrium; default: poisson/(1 - poisson)", .min = 0, .max = 10});
    visit("equilibrium_damping", self.equilibrium_damping, OptionInfo{.text = "local damping in that search", .min = 0, .max = 1, .alias = "settle_damping"});
    visit("equilibrium_tolerance", self.equilibrium_tolerance, OptionInfo{.text = "unbalanced over applied force; default: 1e-3, with [water] 1e-7", .min = 0, .above_min = true, .alias = "settle_tolerance"});
    visit("shape", self.shape, OptionInfo{.text = "shape functions; default: by the scheme"});
    visit("transfer", self.transfer, OptionInfo{.text = "velocity transfer; default: by the scheme"});
    visit("stress_update", self.stress_update, OptionInfo{.text = "order of the stress update; default: by the scheme"});
    visit("locking", self.locking, OptionInfo{.text = "averages against volumetric locking; default: by the scheme (selective, full: bilinear)"});
    visit("damping", self.damping, OptionInfo{.text = "Cundall's local damping; default: 0", .min = 0, .max = 1});
    visit("pic_per_s", self.pic_per_s, OptionInfo{.unit = "1/s", .text = "flip, aflip: rate r of the fraction 1 - exp(-r dt) of PIC; default: flip 0, aflip 10 (g/h)^(1/2)", .min = 0});
    visit("xpic_order", self.xpic_order, OptionInfo{.text = "order of xpic (1: PIC)", .min = 1, .max = 20});
    visit("courant", self.courant, OptionInfo{.text = "time step over h/(c + v); default: 0.4, in dry plane scenes with B-splines up to 0.8", .min = 0, .max = 1, .above_min = true});
    visit("energy_limit", self.energy_limit, OptionInfo{.text = "residual over supplied energy at which the run stops", .min = 0, .above_min = true});
    visit("end_at_rest", self.end_at_rest, OptionInfo{.text = "stop stepping once motion has ended"});
    visit("sleep_below_m_s", self.sleep_below_m_s, OptionInfo{.unit = "m/s", .text = "blocks of cells slower than half of this are not stepped; default: none", .min = 0, .above_min = true});
    visit("end_displacement_m", self.end_displacement_m, OptionInfo{.unit = "m", .text = "stop stepping once a particle or free body has moved so far; default: never", .min = 0, .above_min = true});
    visit("refine", self.refine, OptionInfo{.text = "cells per measured element and side", .min = 1, .max = 16});
    visit("end_s", self.end_s, OptionInfo{.unit = "s", .text = "end of the simulation; default: the last frame", .min = 0, .above_min = true});
    visit("output_rate_hz", self.output_rate_hz, OptionInfo{.unit = "Hz", .text = "states written per second; default: at the frames' times", .min = 0, .above_min = true});
    visit("domain_m", self.domain_m, OptionInfo{.unit = "m", .text = "lower left and upper right corner of the simulation; default: the measured grid"});
    visit("pressure", self.pressure, OptionInfo{.text = "pore pressure explicit, or projected (steps by the skeleton's wave alone); default: projected if twice as fast"});
  }
};

}  // namespace pivnp::mpm

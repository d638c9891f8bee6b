// Water in the pores: one set of points carries skeleton and water (one-point two-phase, u-p). docs/theory/mpm_water.md.
//
// A point's state is its water: `content`, the volume that it would have without pressure, in a unit of initial volume.
// Pores are what the grains leave of the volume, n J = J - (1 - n0), and pressure is what fits the one into the other:
//   p = K_w (content/(n J) - 1),
// with J of the averaged volumetric strain (transfer.hpp): so pressure feels the averages that cure locking. The content
// changes by flow alone, which nodes pass on between points: its sum changes by what crosses the boundaries, to round-off.
//
// Flow: q = -(K/gamma) grad e, potential e = p - rho_w g . x. Points give nodes the mean of e by bilinear hats; along the
// edges between nodes, its differences move water; nodes give their points what came. Where a boundary, or the material's own
// surface, gives the potential, the node has that, and its points are brought towards the field that the nodes span, at the rate
// of a cell: a field that is linear up to the surface is kept. What of the points' potentials no node sees evens out at that rate
// too, and what no node sees of their volumetric strain gives no pressure: points exchange water for it. Without that, nearly
// incompressible mixtures checkerboard.
//
// Momentum sees the normal stress tau' - J (p - p_l), p_l the pressure of the water outside, at rest below a level
// (Particles::excess), and the lift rho_w g of the volume below it: with the divergence theorem that is the load of the water
// on the submerged surface, and soil and water at rest stay so exactly.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mpm/constraint/tractions.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/water/options.hpp"
#include "mpm/water/pore_boundaries.hpp"
#include "mpm/water/pore_lanes.hpp"
#include "mpm/state/pore_node.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

/// What a step's flow did, per metre of thickness.
struct PoreFlow {
  double inflow = 0;    // volume of water without pressure through the boundaries, m^2
  double external = 0;  // work at the boundaries, by the potentials, J
  double darcy = 0;     // dissipated, J
  double yielded = 0;   // projected: taken by the strain that pressures foresee, J

  void add(const PoreFlow& more) {
    inflow += more.inflow;
    external += more.external;
    darcy += more.darcy;
    yielded += more.yielded;
  }
};

class PoreWater {
 public:
  /// `soils`: of each label of `particles`, which must outlive this. Throws InputError naming the key.
  PoreWater(const WaterOptions& options, std::vector<PoreSoil> soils, const ParticleSet& particles, const GridState& g,
            PoreBoundaries boundaries);

  /// The water outside as it is at a time: call before what follows, at each step.
  void set_time(double time);
  bool level_moves() const { return !options_.level_history.empty(); }
  /// Does the level move after that time?
  bool moves_after(double time) const { return !options_.level_history.empty() && time < options_.level_history.back()[0]; }

  /// Contents, pressures and masses at time 0: hydrostatic below the level.
  void start(Particles& p, const GridState& g, const Vec2& gravity, int threads);

  /// Between strain and momentum: moves water from where pressures as they were before the last strain drive it, evens that
  /// strain out, and refreshes. (So a mode of wave and flow takes p' = p - K_w theta/n - lambda dt p.)
  PoreFlow flow(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt, int threads);
  /// From here on pressure is projected: flow_projected() in the place of flow().
  void project(const GridState& g, double foreseen_share);
  bool projected() const { return !system_.empty(); }
  /// The same, stable in the steps of the drained wave: pressures change by what they themselves will do to strain and flow.
  /// `guess`: of the nodes, what they changed by in the last step. Throws RunError.
  PoreFlow flow_projected(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                          std::vector<double>& guess, int threads);
  /// What points pass on and have passed on now, m/s: Darcy's flow of each, x and y in turn.
  std::vector<Vec2> flow_at_points(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time,
                                   int threads);
  /// Particles::pressure and the stress that momentum sees, of contents and skeleton as they are.
  void refresh(Particles& p, const Vec2& gravity, int threads) const;
  /// Mass of the water that each point displaces below the level, kg/m.
  std::vector<double> displaced_mass(const Particles& p) const;

  /// Mass of a point with the water it holds now; what it has where the flow does not change it.
  double mass(const Particles& p, std::size_t k) const;
  double porosity(const Particles& p, std::size_t k) const;
  /// Potential energy of a point in gravity and in the water outside, J/m.
  double potential_energy(const Particles& p, std::size_t k, const Vec2& gravity) const;
  double potential_energy(const Particles& p, const Vec2& gravity, int threads) const;
  /// Elastic energy of the water in a point, J/m.
  double stored(const Particles& p, std::size_t k) const;
  /// Mass of the water in a point, where it flows; else 0. kg/m.
  double flowing_mass(const Particles& p, std::size_t k) const {
    return flows(p, k) ? options_.density_kg_m3 * p.volume0[k] * p.content[k] : 0;
  }
  /// Over the points still simulated: that energy, and the mass of the water that flows, kg/m.
  struct Sums {
    double energy = 0, mass = 0;
  };
  Sums sums(const Particles& p) const;

  /// What the water adds to the stiffness against a compression wave, J K_w/n, the greatest of each material, Pa; and the
  /// greatest diffusivity of pressure, K K_w/(gamma n), m^2/s.
  struct Rates {
    std::vector<double> stiffness;
    double diffusivity = 0;
  };
  Rates rates(const Particles& p) const;
  /// The material holds points above the level, which are dry.
  bool partly_dry(const Particles& p, std::size_t material) const;
  const PoreSoil& soil(std::size_t material) const { return soils_[material]; }

 private:
  const PoreSoil& soil_of(const Particles& p, std::size_t k) const { return soils_[std::size_t(set_->label[p.index[k]])]; }
  bool flows(const Particles& p, std::size_t k) const { return p.content[k] > 0 && soil_of(p, k).holds_water(); }
  double outside_pressure(const Vec2& x, const Vec2& gravity) const;
  double head(const Vec2& x, const Vec2& gravity) const { return options_.density_kg_m3 * gravity.dot(x - reference_); }
  double mobility_of(const Particles& p, std::size_t k) const { return p.mobility.empty() ? alike_.mobility : p.mobility[k]; }
  void refresh_point(Particles& p, std::size_t k, const PoreSoil& soil, const Vec2& gravity) const;
  static double pores_of(const Particles& p, std::size_t k, const PoreSoil& soil) {
    return std::max(least_pores, p.J[k] - (1 - soil.porosity));
  }
  void set_outside(Particles& p, const Vec2& gravity) const;
  void take_soils(Particles& p);
  void follow_porosity(Particles& p, int threads) const;
  PoreView view(const Particles& p, const Vec2& gravity) const;

  // pore_flow.cpp
  void forget_nodes(const GridState& g);
  void map_points(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads);
  void mark_elements(const Particles& p, GridState& g, const Tractions& tractions, double time, int threads);
  void take_means(const GridState& g, const Vec2& gravity, double time, double dt, int threads);
  enum class Surface { none, given, free };
  Surface give_potential(const GridState& g, std::size_t node, const Vec2& gravity, double time);
  double flux_into(const GridState& g, std::size_t node, double time) const;
  void mark_given(bool given);
  PoreFlow at_given_nodes(double rate);
  PoreFlow flow_through_tractions(Particles& p, const Tractions& tractions, double time, double dt) const;
  double length_along(const GridState& g, std::size_t node, std::uint8_t side) const;

  WaterOptions options_;
  std::vector<PoreSoil> soils_;
  const ParticleSet* set_;
  PoreBoundaries boundaries_;
  std::optional<double> level_;  // now
  Vec2 reference_;  // where the potential is the pressure
  struct Alike {
    double mobility = 0, solid = 0;
    bool own = false;
  } alike_;  // of all points; own: each has its own instead
  OfGrid<PoreNode> node_;
  OfGrid<PoreElement> element_;
  OfGrid<PoreMark> mark_;
  PoreSumsView sums_;  // by node; a row and more before the first is zero
  PoreMark* marks_;
  std::vector<OfGrid<double>> fields_;
  PoreFields field_;
  std::vector<std::uint32_t> nodes_;  // of the last flow
  struct Given {
    std::uint32_t node;
    double mobility, mean;  // of its points
  };
  std::vector<Given> given_;  // of this one, with given potentials
  struct Through {
    std::uint32_t node;
    double volume;
  };
  std::vector<Through> through_;  // of this one, by flow that is given
  std::vector<std::uint32_t> free_;  // at a surface that is not held and lets no water through
  std::vector<OfGrid<double>> system_;  // projected
  double inertia_ = 0;  // the least density over the share of its own effect that a pressure foresees
  bool marked_ = false;
  int first_i_, first_j_, last_i_, last_j_;  // nodes of the domain's corners
};

}  // namespace pivnp::mpm

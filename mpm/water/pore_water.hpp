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
// Momentum sees the normal stress tau' - J (p - p_l), p_l the pressure of the water outside, at rest below a level, and the lift
// rho_w g of the volume below it (of drained pores the initial one): with the divergence theorem that is the load of the water
// on the submerged surface, and soil and water at rest stay so exactly.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mpm/constraint/rigid_body.hpp"
#include "mpm/constraint/tied_sides.hpp"
#include "mpm/constraint/tractions.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/state/pore_node.hpp"
#include "mpm/water/options.hpp"
#include "mpm/water/pore_boundaries.hpp"
#include "mpm/water/pore_flow.hpp"
#include "mpm/water/pore_lanes.hpp"
#include "mpm/water/pore_soil.hpp"
#include "pivnp/core/particles/motion.hpp"

namespace pivnp::mpm {

class PoreWater {
 public:
  /// `soils`: of each label of `particles`, which must outlive this, as must `g`, `ties` and `bodies`. Throws InputError naming the key.
  PoreWater(const WaterOptions& options, std::vector<PoreSoil> soils, const ParticleSet& particles, GridState& g,
            PoreBoundaries boundaries, const TiedSides& ties, const RigidBodies& bodies);

  /// The water outside as it is at a time: call before what follows, at each step.
  void set_time(double time);
  /// groundwater = "level": from one time to a later one contents follow the level, each at its place. What came in, and the energy
  /// that the water in the pores gained by it.
  PoreFlow follow_level(Particles& p, const Vec2& gravity, double from, double to, int threads) const;
  bool level_moves() const { return !options_.level_history.empty(); }
  /// Does the level move after that time?
  bool moves_after(double time) const {
    return boundaries_.any_flux() || (!options_.level_history.empty() && time < options_.level_history.back()[0]);
  }

  /// Contents, pressures and masses at time 0: hydrostatic below the level or a given surface, or of the steady flow. Throws InputError,
  /// and RunError where no steady flow is found. (pore_start.cpp)
  void start(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, std::span<const double> given,
             int threads);

  /// Between strain and momentum: moves water from where pressures as they were before the last strain drive it, evens that
  /// strain out, and refreshes. (So a mode of wave and flow takes p' = p - K_w theta/n - lambda dt p.)
  /// With the water's own inertia: `state`, what accelerates() kept.
  PoreFlow flow(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt, int threads,
                std::vector<double>* state = nullptr);
  bool has_inertia() const { return options_.inertia; }
  /// Gives the nodes the force by which flow that changes moves the mixture; before their momentum is updated. (pore_inertia.cpp)
  void push_nodes(GridState& g) const;
  /// Keeps the acceleration of the nodes, when they have moved, in `state`. What they lost to the flow's motion, J/m.
  double accelerates(const GridState& g, double dt, std::vector<double>& state) const;
  /// In the place of K_w/n where the skeleton of a material has this modulus and the mixture this density: of the fastest wave, in which
  /// water does not follow the skeleton.
  double inert_stiffness(std::size_t material, double modulus, double density, double stiffness) const;
  /// From here on pressure is projected: flow_projected() in the place of flow().
  void project(const GridState& g, double foreseen_share);
  bool projected() const { return !system_.empty(); }
  /// The same, stable in the steps of the drained wave: pressures change by what they themselves will do to strain and flow.
  /// `guess`: of the nodes, what they changed by in the last step. Throws RunError.
  PoreFlow flow_projected(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt,
                          std::vector<double>& guess, int threads);
  /// What points pass on and have passed on now, m/s: Darcy's flow of each, x and y in turn.
  std::vector<Vec2> flow_at_points(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time,
                                   int threads, const std::vector<double>* state = nullptr);
  /// Particles::pressure and the stress that momentum sees, of contents and skeleton as they are.
  void refresh(Particles& p, const Vec2& gravity, int threads) const;
  /// At a node, over points that hold water: the excess pressure, as a boundary gives it or as the points have it, and the force
  /// with which it presses their face there (their area by the shape functions of the momentum), out of the material. (pore_faces.cpp)
  struct Thrust {
    bool pores = false;
    double pressure = 0;            // Pa
    Vec2 force = Vec2::Zero();      // N/m
  };
  std::vector<Thrust> thrust(const Particles& p, const GridState& g, const Vec2& gravity, double time,
                             const std::vector<std::uint32_t>& nodes, int threads) const;
  /// Mass of the water that each point displaces below the level, kg/m.
  std::vector<double> displaced_mass(const Particles& p) const;

  /// Mass of a point with the water it holds now; what it has where the flow does not change it.
  double mass(const Particles& p, std::size_t k) const;
  /// Masses of points of one soil that holds water, as many together as there are lanes: carry_water_lanes().
  double carry_in_lanes(const Particles& p, const PointView& points, const Vec2& spacing, const Vec2& gravity,
                        Range& range) const {
    const PoreMasses of{soils_.front().dry_density(), options_.density_kg_m3, spacing.x(), spacing.y(),
                        !front_.empty()};
    return carry_water_lanes(points, view(p, gravity), p.cell.data(), of, range);
  }
  /// Potential energy with which a mass of water comes into a drained point, which follows the level; J/m, 0 for others.
  double brought(const Particles& p, std::size_t k, double mass, const Vec2& gravity) const {
    return flows(p, k) || owes(p, k) || !level_
               ? 0
               : mass * -gravity.dot(Vec2(p.x[k], *level_) - Vec2(p.x[k], reference_.y()));
  }
  double porosity(const Particles& p, std::size_t k) const;
  /// Over that of the water outside, Pa.
  double excess_pressure(const Particles& p, std::size_t k, const Vec2& gravity) const {
    return p.pressure[k] - outside_pressure({p.x[k], p.y[k]}, gravity);
  }
  /// Potential energy of a point in gravity and in the water outside, J/m.
  double potential_energy(const Particles& p, std::size_t k, const Vec2& gravity) const;
  double potential_energy(const Particles& p, const Vec2& gravity, int threads) const;
  /// Energy of the water in a point, J/m: elastic, and where pores are not full what filling the fringe gives.
  double stored(const Particles& p, std::size_t k, const Vec2& gravity) const;
  /// Mass of the water in a point, where it flows; else 0. kg/m.
  double flowing_mass(const Particles& p, std::size_t k) const {
    return flows(p, k) || owes(p, k) ? options_.density_kg_m3 * p.volume0[k] * p.content[k] : 0;
  }
  /// Where its properties follow the temperature: permeability is given at this one, and from here on that of the points counts.
  void take_reference_temperature(Particles& p, double celsius);
  /// Mobilities of the points as they are warm now.
  void follow_temperature(Particles& p, int threads) const;
  /// Water and grains of a point swell by this share of the initial volume (heat). The energy that its water gains, J/m.
  double swell(Particles& p, std::size_t k, double by) const;
  /// Darcy's flow in the last step from a node to the next one along x and y, m^2/s, and what it dissipated, W/m.
  struct EdgeFlow {
    double x = 0, y = 0, heat_x = 0, heat_y = 0;
  };
  EdgeFlow edge_flow(const GridState& g, std::size_t node) const;
  /// What the point's water dissipated in the last step as it evened out in its cell, W/m.
  double evening(const Particles& p, const GridState& g, std::size_t k, const Vec2& gravity) const;
  /// Over the points still simulated: that energy, and the mass of the water that flows, kg/m; and of the pressure over that of the
  /// water outside, times the volume, and of its square; that volume.
  struct Sums {
    double energy = 0, mass = 0, excess = 0, excess2 = 0, volume = 0;
  };
  Sums sums(const Particles& p, const Vec2& gravity) const;

  /// What the water adds to the stiffness against a compression wave, J K_w/n, the greatest of each material, Pa, for a
  /// point as heavy as at the start; and the greatest diffusivity of pressure, K K_w/(gamma n), m^2/s.
  struct Rates {
    std::vector<double> stiffness;
    double diffusivity = 0;
    double least_pores = 1;  // of a point, over those at the start
  };
  Rates rates(const Particles& p) const;
  /// Pores are not all full, or a level moves.
  bool surface_may_move(const Particles& p) const;
  /// A point has lost more water than it held.
  bool overdrawn(const Particles& p) const;
  /// The material holds points above the level, which are dry.
  bool partly_dry(const Particles& p, std::size_t material) const;
  const PoreSoil& soil(std::size_t material) const { return soils_[material]; }

 private:
  const PoreSoil& soil_of(const Particles& p, std::size_t k) const {
    return soils_.size() == 1 ? soils_.front() : soils_[std::size_t(set_->label[p.index[k]])];
  }
  bool flows(const Particles& p, std::size_t k) const { return (p.content[k] > 0 || !front_.empty()) && soil_of(p, k).holds_water(); }
  // A point that has passed on more than it held, as its pores shrank or what they hold swelled, takes part in no flow
  // any more, but what others have of it stays in the books.
  bool owes(const Particles& p, std::size_t k) const { return p.content[k] < 0 && soil_of(p, k).holds_water(); }
  double outside_pressure(const Vec2& x, const Vec2& gravity) const;
  double pressure_of(const Particles& p, std::size_t k, bool tears) const;
  bool by_temperature() const { return options_.properties == WaterProperties::by_temperature; }
  double thinned(const Particles& p, std::size_t k) const;  // viscosity at the reference temperature over that of the point
  bool tears() const { return imposed(); }
  bool torn(const Particles& p, std::size_t k, const PoreSoil& soil) const;
  bool has_surface() const { return level_ || !options_.surface_m.empty(); }
  bool imposed() const { return options_.groundwater == Groundwater::level; }
  double level_at(double time) const;  // with a level
  double surface_at(double x) const;  // at the start
  void check_start(const Vec2& gravity) const;
  void fill_below_surface(Particles& p, const Vec2& gravity) const;
  void fill_as_given(Particles& p, const Vec2& gravity, std::span<const double> given) const;
  class Seepage;
  void fill_by_seepage(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, int threads);
  /// p without e: rho_w g . x, or where a level is imposed the pressure of the water outside.
  double head(const Vec2& x, const Vec2& gravity) const {
    return imposed() ? outside_pressure(x, gravity) : options_.density_kg_m3 * gravity.dot(x - reference_);
  }
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
  std::vector<std::uint32_t> special_nodes(const GridState& g,
                                           const std::vector<std::vector<std::uint32_t>>& parts) const;
  void take_means(const GridState& g, const Vec2& gravity, double time, double dt, int threads);
  void exchange_row_by_row(const GridState& g, const PoreFields& f, double rate) const;
  enum class Surface { none, given, free };
  Surface give_potential(const GridState& g, std::size_t node, const Vec2& gravity, double time);
  /// Water that a wall's flow brings to a node, m^2/s.
  template <class Holds>
  double flux_into(const GridState& g, std::size_t n, double time, Holds&& holds) const {
    const PoreCondition* condition = boundaries_.at(n, time);
    return condition && condition->kind == PoreCondition::flux ? condition->value * length_along(g, n, boundaries_.side(n, time), holds) : 0;
  }
  void conduct_to_surface(const GridState& g, double dt);
  void mark_given(bool given);
  PoreFlow at_given_nodes(double rate);
  template <class Each>
  void for_flow_through_tractions(const Particles& p, const Tractions& tractions, double time, double dt,
                                  Each&& each) const;
  void take_flow_through_tractions(const Particles& p, const GridState& g, const Tractions& tractions, double time,
                                   double dt);
  PoreFlow fill_through_tractions(Particles& p, const Tractions& tractions, const Vec2& gravity, double time,
                                  double dt) const;
  /// Of a node beside loaded points.
  bool loaded_with_flow(std::size_t n) const {
    return marked_ && marks_[n].loaded > 0 && boundaries_.gives_flux(std::size_t(marks_[n].loaded - 1));
  }
  // Axisymmetric: volumes are those of a radian, and surfaces of rings.
  bool about_axis() const { return field_.radius != nullptr; }
  double radius_of(std::size_t n) const { return about_axis() ? field_.radius[n] : 1; }
  double share_of_right(std::ptrdiff_t n) const { return about_axis() ? field_.of_right[n] : 0.5; }
  double share_of_left(std::ptrdiff_t n) const { return about_axis() ? field_.of_left[n] : 0.5; }
  /// Radius of the middle of the element up and to the right of a node, and the volume that it can hold; in the plane 1, and its area.
  double ring(const GridState& g, std::ptrdiff_t element) const {
    return about_axis() ? g.position(std::size_t(element)).x() + 0.5 * g.grid.spacing.x() : 1;
  }
  double full_element(const GridState& g, std::ptrdiff_t element) const { return ring(g, element) / (g.per_hx * g.per_hy); }
  double section(const Particles& p, std::size_t k, double volume) const { return about_axis() ? volume / p.x[k] : volume; }
  void set_rings(GridState& g);
  /// Surface of a node at a wall: its length, or that times the radius. `holds`: does an element hold water?
  template <class Holds>
  double length_along(const GridState& g, std::size_t n, std::uint8_t side, Holds&& holds) const {
    const auto beside = [&](int left, int below) { return holds(std::ptrdiff_t(n) - left - below * std::ptrdiff_t(g.grid.nx)); };
    const double upright = (about_axis() ? g.position(n).x() : 1) * g.grid.spacing.y();
    const auto level = [&](int below) {
      const auto part = [&](int left) {
        if (!beside(left, below)) return 0.0;
        return left ? share_of_left(std::ptrdiff_t(n)) * ring(g, std::ptrdiff_t(n) - 1) : share_of_right(std::ptrdiff_t(n)) * ring(g, std::ptrdiff_t(n));
      };
      return (part(0) + part(1)) * g.grid.spacing.x();
    };
    const auto half = [&](int left, int below) { return beside(left, below) ? 0.5 : 0.0; };
    switch (side) {
      case wall_left: return (half(0, 0) + half(0, 1)) * upright;
      case wall_right: return (half(1, 0) + half(1, 1)) * upright;
      case wall_down: return level(0);
      default: return level(1);
    }
  }
  double given_pressure(const PoreCondition& condition, const Vec2& x, const Vec2& gravity) const {
    if (condition.kind == PoreCondition::pressure) return condition.value;
    if (condition.kind == PoreCondition::level) return std::max(0.0, options_.density_kg_m3 * -gravity.y() * (condition.value - x.y()));
    return outside_pressure(x, gravity);
  }
  /// Is a node at the material's own surface? `holds`: does an element hold material? `volume`: around the node, of that.
  template <class Holds>
  bool at_surface(const GridState& g, std::size_t n, double volume, double time, Holds&& holds) const;

  // pore_inertia.cpp
  void check_inertia(const Particles& p, const Vec2& gravity) const;
  PoreFlow push_flow(const GridState& g, double dt, std::vector<double>& state);
  Vec2 inert_flow(const GridState& g, std::size_t node, double s, double t, const std::vector<double>& state) const;
  std::vector<Vec2> pushed_;  // on the nodes, in this step, N/m

  // pore_borders.cpp: between soils of different permeability
  void mix_at_borders(Particles& p, const GridState& g, int threads);
  void conduct_along_borders(const GridState& g, double dt);
  /// What weights the points' potentials at a node, and what flows there to them: V, or where it varies V times the mobility.
  double capacity(std::size_t n) const { return alike_.own ? field_.volume[n] * field_.rate[n] : field_.volume[n]; }
  /// Volume of the pores at a node, projected.
  double pores_at(std::size_t n) const { return alike_.own ? pores_[n] : sums_.node[n].mobile; }
  void take_pores(const Particles& p, const GridState& g, int threads);
  struct Mixed {  // an element with more than one soil
    std::uint32_t element;
    double volume = 0, conducting = 0, resisting = 0;  // V; V times, and over, the mobility
    double s = 0, t = 0, log = 0, log_s = 0, log_t = 0;  // V times the place in the element, and with the mobility's logarithm
  };
  std::vector<Mixed> mixed_;
  std::vector<std::uint8_t> soil_in_;  // of each element: the kind of its soil (kinds_of()), or several_soils
  std::vector<double> pores_;          // of nodes, where permeability varies

  // pore_projection.cpp
  void yield_beside_surface(const GridState& g, double inertia, double* added) const;

  // pore_neighbours.cpp
  bool covered(const GridState& g, std::size_t element, double time) const;  // by a rigid body
  double head_across(const GridState& g, const TiedSides::Tie& tie, const Vec2& gravity) const;
  void tie_sums(const GridState& g, const Vec2& gravity, double time);
  void tie_given(const GridState& g, const Vec2& gravity);
  void tie_smoothed(const double* from, double* to) const;
  void keep_means();
  PoreFlow tie_exchanged(const GridState& g, const Vec2& gravity, double rate);

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
  PoreSumsView sums_;  // NodeArrays::pores by node; a row and more before the first is zero
  PoreMark* marks_;
  PoreFields field_;  // NodeArrays::flow
  std::vector<std::uint32_t> nodes_;  // of the last flow
  struct Given {
    std::uint32_t node;
    double mobility, mean;  // of its points
    double share = 1;       // of the node's volume that is its own (tied)
  };
  std::vector<Given> given_;  // of this one, with given potentials
  struct Through {
    std::uint32_t node;
    double volume;
  };
  std::vector<Through> through_;  // of this one, by flow that is given
  std::vector<std::uint32_t> free_;  // at a surface that is not held and lets no water through
  std::vector<std::uint32_t> surface_;  // of the material itself, where no wall is
  std::vector<OfGrid<double>> system_;  // projected
  double reference_viscosity_ = 0;  // by temperature; 0: not known yet
  double inertia_ = 0;  // the least density over the share of its own effect that a pressure foresees
  bool marked_ = false;
  const TiedSides* ties_;
  const RigidBodies* bodies_;
  struct Joined {
    const TiedSides::Tie* tie;
    double share[2];      // of each node in what weights the means of both
    double potential[2];  // mean of each one's own points
    double mean, even;    // before the exchange
  };
  std::vector<Joined> joined_;  // in this step

  // pore_front.cpp
  struct FrontPoint {  // between its four nodes
    std::size_t at[4];
    double w[4], s, t;
    double volume, share, potential, bottom, height, mobility, strain;

    double reached(double e) const { return std::max(share, std::clamp((e - bottom) / height, 0.0, 1.0)); }
  };
  bool sees_air(const Vec2& gravity) const { return !projected() && !imposed() && gravity.y() < 0 && (has_surface() || boundaries_.any_level()); }
  double fringe(const Particles& p, std::size_t k, const Vec2& gravity) const;
  double filled(const Particles& p, std::size_t k) const;
  double potential_in_pores(const Particles& p, std::size_t k, double filled, const Vec2& gravity) const;
  bool has_front(const Particles& p, const Vec2& gravity, int threads) const;
  FrontPoint front_point(const Particles& p, const GridState& g, std::size_t k, const Vec2& gravity) const;
  double lack_in_front(const FrontPoint& at) const;
  Vec2 darcy_in_front(const FrontPoint& at, const GridState& g) const;
  std::vector<Vec2> flow_in_front(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads);
  PoreFlow flow_with_front(Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, double dt, int threads);
  void map_front(const Particles& p, GridState& g, const Tractions& tractions, const Vec2& gravity, double time, int threads);
  /// At a node's boundary or the material's surface, where water may pass: its pressure, and whether water stands there.
  struct Opening {
    double pressure;
    bool stands;
  };
  std::optional<Opening> opening(const GridState& g, std::size_t n, const Vec2& gravity, double time) const;
  void give_front(const GridState& g, const Vec2& gravity, double time, int threads);
  void smooth_front(const GridState& g, double PoreFrontNode::*value, double PoreFrontNode::*scratch, int threads);
  void add_front(const Particles& p, GridState& g, const Vec2& gravity, int threads);
  PoreFlow change_front(const GridState& g, double time, double dt, int threads);
  PoreFlow change_behind_front(Particles& p, GridState& g, const Vec2& gravity, double dt, int threads);
  double collapse(Particles& p, std::size_t k, const PoreSoil& soil) const;
  std::vector<PoreFrontNode> front_;  // of the whole grid; zero between steps; empty until there is a front
  int first_i_, first_j_, last_i_, last_j_;  // nodes of the domain's corners
};

inline constexpr double least_share = 0.25;  // of a node's volume inside the material: with less it is at a surface

// An element beside a node counts unless it is behind a wall along the grid or sealed: what another body of material or a rigid one
// fills lets no water through. The material's surface is where one of those that count is empty, as all beyond the domain are.
template <class Holds>
bool PoreWater::at_surface(const GridState& g, std::size_t n, double volume, double time, Holds&& holds) const {
  const std::vector<std::uint32_t>& partial = g.active.partial;  // material goes on there, asleep
  if (!partial.empty() && std::binary_search(partial.begin(), partial.end(), std::uint32_t(n))) return false;
  const auto row = std::size_t(g.grid.nx);
  const int i = int(n % row), j = int(n % g.field_nodes() / row);
  const std::uint8_t walls = g.sides[n];
  const auto sealed = [&](std::size_t element) {
    for (int field = 0; g.velocity_fields > 1 && field < g.velocity_fields; ++field)
      if (holds(element % g.field_nodes() + std::size_t(field) * g.field_nodes())) return true;
    return covered(g, element, time);
  };
  int open = 0;
  bool surface = false;
  for (int c = 0; c < 4; ++c) {
    const int left = 1 - c % 2, below = 1 - c / 2, ei = i - left, ej = j - below;
    if (walls & ((left ? wall_left : wall_right) | (below ? wall_down : wall_up))) continue;
    const bool beyond = ei < first_i_ || ei >= last_i_ || ej < first_j_ || ej >= last_j_;
    const std::size_t element = n - std::size_t(left) - std::size_t(below) * row;
    const bool empty = beyond || !holds(element);
    if (empty && !beyond && sealed(element)) continue;
    ++open;
    surface = surface || empty;
  }
  return surface || volume * g.per_hx * g.per_hy < least_share * 0.25 * open * radius_of(n);
}

}  // namespace pivnp::mpm

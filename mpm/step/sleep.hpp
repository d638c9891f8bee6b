// Sleeping: blocks of cells at rest that are not stepped (an option; off by default).
//
// One speed v is the tolerance. With n a node's velocity, m (n - v_i)/dt its unbalanced force, c the speed of a wave
// and h the cell, r = |n| + |m (n - v_i)|/(dt rho c h) is what the node does now, and what that force over h, as a
// stress rho c r, would make the material do. A block falls asleep when r <= v/2 at all its nodes, at every look (each
// tenth step), for twice the time a wave takes through the material (so that half a period of its slowest oscillation
// is seen). Its points keep their places and stresses; their velocity is taken, its energy counts as damped.
//
// The nodes of sleeping cells stand still, as on a fixed wall, which does no work. Those that awake cells share get force
// and mass from both sides; where r (before they are stopped) passes v, the sleeping blocks there are woken. So are
// blocks that a point moves into or a moving body comes near, and all of them when a wall, body or load changes.
//
// Water in the pores. r has Darcy's flow besides, so that nothing sleeps that consolidates or is seeped through faster than
// v/2, and its pressure must be at rest: what it would still change by at the rate at which it changed while it was watched, in
// the time 4 H^2/(pi^2 c_v) in which the material's shorter side drains, is rho c v/2 at most (c here being the skeleton's). In the rim water
// still flows, between it and what is awake alone (beyond it lies material: no surface), and a block in which a pressure has
// changed by more than rho c v since it was quiet is woken.
//
// What is left out. While a block sleeps it would have gone on no faster than it did when it fell asleep (w, the
// greatest speed of its nodes while it was watched): at most the sum of w times the time asleep. A stress below rho c v
// held back at its border would have displaced a stable material of extent L by v L/c. The sum of both is the bound
// reported; material on the verge of failure, which a smaller stress could set in motion, is not held by it.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "mpm/constraint/restraints.hpp"
#include "mpm/grid/grid_state.hpp"
#include "mpm/state/particles.hpp"

namespace pivnp::mpm {

/// Part of a checkpoint; an entry a block of cells (SleepingBlocks::of_cell), none without the option.
struct SleepState {
  std::vector<std::uint8_t> asleep;
  std::vector<double> quiet_since;  // s; below 0: it is not quiet
  std::vector<double> speed;        // greatest nodal speed since then, m/s
  std::vector<double> foregone;     // sum of that times the time asleep, m
  std::vector<double> pressure;     // of each point of the scene since its block is quiet, Pa; with water alone
  double held_back = 0;             // greatest v L/c while anything slept, m
  double energy = 0;                // kinetic energy taken, J/m
  double skipped = 0, all = 0;      // steps of points: not made, and in all
};

class Sleep {
 public:
  /// `below`: the speed v; none: nothing sleeps. Throws InputError if it is not above 0.
  Sleep(std::optional<double> below, SleepState& state);
  /// All awake.
  void start(const Particles& p, const GridState& g);

  bool on() const { return below_ > 0; }
  void wake_all();
  using Corners = std::pair<Vec2, Vec2>;  // low, high
  /// Before the points are located: what was woken takes part from here on. `moving`: where bodies move.
  void begin_step(const std::vector<Corners>& moving, GridState& g);
  /// After they have been located: wakes what points have moved into and, `look_now`, puts to sleep what has been quiet
  /// for `window` seconds. Returns the kinetic energy taken, J/m.
  double fall_asleep(bool look_now, double time, double window, Particles& p, GridState& g);
  /// Stops Node::n of sleeping cells' nodes. `per_mass`: 1/(dt rho c h), m/kg.
  void hold(double per_mass, GridState& g);
  /// Stops the strain-rate velocity likewise.
  void hold_strain_velocity(GridState& g) const;
  /// After a step: how quiet the blocks are. `across`: time of a wave through the material, s; `flow`: of the water in
  /// each point, m/s; none without.
  void look(double time, double per_mass, double across, const GridState& g, const std::vector<Reaction>& reactions,
            std::span<const Vec2> flow);
  /// After look(), with water: wakes blocks whose pressure has changed, and has those watched anew in which it is not at rest.
  struct PressureWatch {
    double time, window;  // s; as look() and fall_asleep()
    double most;          // change that is held back, Pa
    double settles;       // time in which all of a pressure's change is still to come at its rate, s
  };
  void watch_pressure(const PressureWatch& watch, const Particles& p, const GridState& g);
  /// After a step: counts what was left out.
  void count(double dt, std::size_t points);
  /// After a restart.
  void resume(GridState& g);

  bool any() const { return any_; }

 private:
  template <class Each>
  void for_blocks_of_node(const GridState& g, std::uint32_t node, Each&& each) const;
  void wake(std::size_t block);
  void apply(GridState& g);

  double below_ = 0, least_ = 0;  // m/s; kg/m
  SleepState& state_;
  bool changed_ = false, any_ = false;
  std::size_t sleepers_ = 0;        // points
  std::vector<double> unrest_, speed_;  // of look()
};

}  // namespace pivnp::mpm

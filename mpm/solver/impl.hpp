// What the sources of Solver share; no one else includes it.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mpm/constraint/contact.hpp"
#include "mpm/constraint/restraints.hpp"
#include "mpm/constraint/rigid_body.hpp"
#include "mpm/heat/heat.hpp"
#include "mpm/material/model.hpp"
#include "mpm/scene/loading.hpp"
#include "mpm/scene/scene_setup.hpp"
#include "mpm/solver/solver.hpp"
#include "mpm/solver/state.hpp"
#include "mpm/step/half_step.hpp"
#include "mpm/step/initial_equilibrium.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/step/sleep.hpp"
#include "mpm/step/thread_choice.hpp"
#include "mpm/transfer/nonlocal.hpp"
#include "mpm/transfer/transfer.hpp"
#include "mpm/water/pore_water.hpp"

namespace pivnp::mpm {

// What stays readable after a failure: of the last state that passed check_balance(). (A copy of the state itself would
// be a fifth of the memory; the record holds what was written before.)
struct LastGood {
  EnergyRow energy;
  std::int64_t steps = 0;
};

/// What the water sees of the scene's materials, which become what dry laws see. Throws InputError for what does not go with it.
std::vector<PoreSoil> take_pores(const MpmOptions& options, Scene& scene);

/// What heat sees of the scene's materials; call before take_pores(). Throws InputError for what does not go with it.
std::vector<HeatSoil> take_heat(const MpmOptions& options, const Scene& scene);

/// The scene, after a look at what does not go with axial symmetry or a centrifuge (InputError), with a roller along the axis of
/// symmetry where the grid begins there.
Scene checked(const MpmOptions& options, Scene scene);
inline constexpr const char* axis_boundary = "axis of symmetry";

struct Solver::Impl {
  Impl(const MpmOptions& o, Scene s, int n_threads);

  bool steps_by_arrangement() const;
  double courant() const;
  double longest_step() const;
  void set_walls(double time);
  double next_change(double time) const;
  double least_density() const { return *std::min_element(density.begin(), density.end()); }

  // step.cpp: the cycle.
  struct Cycle {
    double dt;
    double push;   // for which forces act, s (half_step.hpp)
    int threads;
    Vec2 gravity;  // at its start, as the other forces: velocities are those between two states
    Vec2 moment;   // moment_of_mass() at its start, where work_in_steps()
  };
  void step(double dt);
  bool leaps() const { return scheme.stress != StressUpdate::usf && !water; }
  void catch_up();
  bool forces_jump(double time) const;
  double settling_rate(const Vec2& gravity) const;
  Cycle begin_step(double dt);
  void find_cells(const Cycle& c);
  void map_to_nodes(const Cycle& c);
  void strain_first(const Cycle& c);
  void advance_nodes(const Cycle& c);
  void restrain_nodes(const Cycle& c);
  void move_points(const Cycle& c);
  void strain_last(const Cycle& c);
  void end_step(const Cycle& c);
  bool maps_and_advances() const;
  SmallMassNodes::Rule small_nodes() const;
  double load_strain() const;
  void take_mapped_velocity(const Cycle& c);
  void apply_restraints(const Cycle& c, bool counted);
  void restrain_strain_velocity();
  void strain(const Cycle& c, GatherSums* moved = nullptr);

  // loads.cpp: what changes by the case's will.
  void load(double dt);
  void map_loads(double dt, int threads);
  void turn_by_coriolis(const Cycle& c);
  Vec2 gravity_at_rest() const { return loading.gravity_at(centroid(scene.particles), 0); }
  std::function<Vec2(const Vec2&)> variation_of_gravity() const;
  RigidBodies::Field field_of_bodies() const;
  void change_densities(double time, bool balance);
  void change_strength(double time);
  void remove_due();
  void end_bad_states();
  void start_at_rest(const Vec2& gravity);
  // SolverState::impulses: of the walls, of every boundary as far as it is a traction, of the bodies, of every [contact.NAME].
  std::span<Impulse> impulses_of_walls() { return {state.impulses.data(), restraints.walls().size()}; }
  std::span<Impulse> impulses_of_tractions() {
    return {state.impulses.data() + restraints.walls().size(), scene.boundaries.size()};
  }
  std::span<Impulse> impulses_of_bodies() {
    return {state.impulses.data() + restraints.walls().size() + scene.boundaries.size(), bodies.size()};
  }
  std::span<Impulse> impulses_of_contacts() {
    return {state.impulses.data() + state.impulses.size() - scene.contacts.size(), scene.contacts.size()};
  }
  bool pushes() const { return scene.body_force || loading.centrifuge() || loading.tractions().any(); }
  bool work_in_steps() const { return !water && (loading.gravity_changes() || loading.any_density()); }
  bool balance_averages(EquilibriumOptions o, Scheme& used, const StaticSystem& system, Progress& progress);
  Vec2 moment_of_mass() const;

  // water.cpp: the water in the pores.
  void fill_pores();
  std::vector<double> undrained_stiffness() const;
  void choose_pressure();
  std::string against_projection(double crossing) const;
  void carry_water(const Cycle& c);
  void follow_level(const Cycle& c);
  void flow_water(const Cycle& c);
  int parts_of_flow(double dt) const;
  void press_faces(const Cycle& c, bool counted);
  void end_water(std::size_t k);
  void put_water(MotionFrame& frame);
  bool has_inertia() const { return water && scene.water->inertia; }  // the water's own
  bool water_works_in_steps() const { return loading.gravity_changes() || water->level_moves(); }
  double potential_of_water() const { return water->potential_energy(p, loading.gravity(state.time), most_threads); }
  void take_wave_speed(int threads);

  // heat.cpp: temperature.
  void start_heat();
  void heat_points(const Cycle& c);
  void take_work();
  void end_heat(std::size_t k);
  void count(const HeatSums& sums);
  void put_heat(MotionFrame& frame) const;

  // sleep.cpp: what is not stepped while it rests.
  void wake_what_moves();
  void start_sleep();
  void let_sleep();
  double wave_of_rest() const;
  void look_for_rest(double dt);
  Vec2 extent() const;
  double wave_across() const;
  double push_per_mass(double dt) const { return 1 / (dt * wave_of_rest() * least_density() * g.grid.spacing.maxCoeff()); }

  // watch.cpp: energy, rest and failure.
  void add_work(const Cycle& c);
  void end_particle(std::size_t k, EndReason reason);
  void watch_motion();
  bool pressure_lasts();
  bool moved_far() const;
  double work_of_gravity() const;
  EnergyRow energy();
  EnergyRow energy_now();
  void bring_to_time(MotionFrame& frame) const;
  Impulse impulse_now(std::size_t k) const;  // in the order of SolverState::impulses
  void check_balance();
  [[noreturn]] void fail(const std::string& cause);
  void restart_balance();
  void restore_ends(const std::vector<SolverState::Ended>& before);

  MpmOptions options;
  Scheme scheme;
  int most_threads;
  ThreadChoice choice;
  Scene scene;
  std::vector<HeatSoil> warm;   // of the scene's materials; empty without heat
  std::vector<PoreSoil> pores;  // of the scene's materials
  Materials materials;
  std::vector<double> density;
  Contacts contacts;
  GridState g;
  Restraints restraints;
  RigidBodies bodies;
  Loading loading;
  std::vector<double> reduction;  // by which the materials' strengths are divided now
  SolverState state;
  Sleep sleep{options.sleep_below_m_s, state.sleep};
  double skeleton_speed = 0;  // of waves in it at the start, m/s
  double consolidates = 0;    // least c_v of a soil at the start, m^2/s; 0: none flows
  double least_turned_over = 0;  // least_turnover()
  LastGood good;
  PoreWater::Sums excess_now;    // when the balance was last looked at
  bool failed = false;  // only `good` is meant any more
  Particles& p = state.particles;
  std::unique_ptr<PoreWater> water;  // null without
  std::unique_ptr<Heat> heat;        // likewise
  bool heat_due = false;             // in this step, as a state is written after it
  std::string pressure_choice;       // why pressure is explicit or projected; empty where mpm.pressure was given
  bool flows_in_parts = false;       // of a step, which then is that of the waves alone
  std::vector<double> strained_to;   // by points: J of a step that flows in parts
  double potential_energy = 0;       // with water that works in steps: of the points at the step's start
  GatherSums gather;
  LastPush last;                        // of the last step
  std::vector<Impulse> impulses_before;  // the last step
  SmallMassNodes small_mass;
  NonlocalSoftening nonlocal;
  std::vector<Reaction> reactions;
  std::function<void(double, const VelocityAt&)> observer;
};

}  // namespace pivnp::mpm

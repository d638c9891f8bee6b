// What the sources of Solver share; no one else includes it.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "mpm/constraint/boundary.hpp"
#include "mpm/constraint/contact.hpp"
#include "mpm/step/loading.hpp"
#include "mpm/step/momentum.hpp"
#include "mpm/transfer/nonlocal.hpp"
#include "mpm/constraint/rigid_body.hpp"
#include "mpm/step/scene_setup.hpp"
#include "mpm/step/sleep.hpp"
#include "mpm/step/solver.hpp"
#include "mpm/step/solver_state.hpp"
#include "mpm/step/thread_choice.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

// What stays readable after a failure: of the last state that passed check_balance(). (A copy of the state itself would
// be a fifth of the memory; the record holds what was written before.)
struct LastGood {
  EnergyRow energy;
  std::int64_t steps = 0;
};

struct Solver::Impl {
  Impl(const MpmOptions& o, Scene s, int n_threads);

  // solver.cpp: the cycle.
  void step(double dt);
  void find_cells(int threads);
  void update_nodes(const Vec2& gravity, double dt, int threads);
  void restrain_momentum(double dt);
  void restrain_velocity();
  void choose_strain_velocity(double dt, int threads);
  void strain(double dt, int threads, GatherSums* moved = nullptr);
  double longest_step() const;
  double next_change(double time) const;
  double least_density() const { return *std::min_element(density.begin(), density.end()); }

  // solver_loads.cpp: what changes by the case's will.
  void load(double dt);
  void map_body_force(int threads);
  void change_densities(double time, bool balance);
  void change_strength(double time);
  void remove_due();
  void start_at_rest(const Vec2& gravity);
  void place_tractions();
  bool pushes() const { return scene.body_force || !loading.pushed().empty(); }
  bool work_in_steps() const { return loading.gravity_changes() || loading.any_density(); }
  Vec2 moment_of_mass() const;

  // solver_sleep.cpp: what is not stepped while it rests.
  void wake_what_moves();
  void let_sleep();
  void look_for_rest(double dt);
  double wave_across() const;
  double push_per_mass(double dt) const { return 1 / (dt * state.wave_speed * least_density() * g.grid.spacing.maxCoeff()); }

  // solver_watch.cpp: energy, rest and failure.
  void add_work(double dt, int threads);
  void end_particle(std::size_t k, EndReason reason);
  void watch_motion();
  bool moved_far() const;
  double work_of_gravity() const;
  EnergyRow energy();
  void check_balance();
  [[noreturn]] void fail(const std::string& cause);
  void restart_balance();
  void restore_ends(const std::vector<SolverState::Ended>& before);

  MpmOptions options;
  Scheme scheme;
  int most_threads;
  ThreadChoice choice;
  Scene scene;
  Materials materials;
  std::vector<double> density;
  Contacts contacts;
  GridState g;
  Restraints restraints;
  RigidBodies bodies;
  Loading loading;
  std::vector<double> reduction;  // by which the materials' strengths are divided now
  std::vector<std::int32_t> pushed_at;  // of every particle: its entry in Loading::pushed(); -1: none
  SolverState state;
  Sleep sleep{options.sleep_below_m_s, state.sleep};
  LastGood good;
  bool failed = false;  // only `good` is meant any more
  Particles& p = state.particles;
  GatherSums gather;
  SmallMassNodes small_mass;
  NonlocalSoftening nonlocal;
  std::vector<double> filtered, pushed;  // x, y of every node: XPIC's velocity, Scene::body_force
  std::vector<Reaction> reactions;
  std::function<void(double, const VelocityAt&)> observer;
};

}  // namespace pivnp::mpm

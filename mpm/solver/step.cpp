// The cycle of appendix A; equation numbers are the thesis'.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/sweeps.hpp"
#include "mpm/solver/impl.hpp"
#include "mpm/step/own_frequency.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t stiffness_every = 8;  // steps between looks at the wave speed
constexpr std::int64_t arrangement_every = 8;  // steps between looks at how the points lie
constexpr std::int64_t mass_every = 8;       // steps between looks at the mass of the water
constexpr double sort_share = 0.05;          // of the points that may change cells between re-sorts of the storage
constexpr double least_mass = 1e-5;          // of a full cell: lighter nodes move with a neighbour
constexpr double least_loaded_mass = 1e-2;   // likewise with stress last, where faces bear loads: docs/theory/mpm.md#small-mass-nodes
constexpr double least_linear_mass = 4e-2;   // likewise with water between linear functions: docs/theory/mpm_water.md#light-nodes
constexpr double fades_in_fall = 10;       // AFLIP: rate of PIC over (g/h)^(1/2)
constexpr double touched_share = 0.25;            // of a full cell: mass around a body's outline in contact

}  // namespace

void Solver::Impl::step(double dt) {
  const Cycle c = begin_step(dt);
  find_cells(c);                        // A.1, A.2: cells and natural coordinates of the points
  nonlocal.average(p, g, c.threads);    //           (the strain around each that softens it)
  map_to_nodes(c);                      // A.3, A.4: mass, velocity v and internal force of the nodes
  strain_first(c);                      //           (usf: A.12, A.13, A.22-A.24 by v, then A.4)
  advance_nodes(c);                     // A.5-A.7:  force and updated velocity n
  restrain_nodes(c);                    //           walls, contact and bodies act on n
  move_points(c);                       // A.8-A.11: velocity and place of the points
  strain_last(c);                       // A.12, A.13, A.22-A.24: their strain increment and stress
  end_step(c);
}

// The rate at which velocities between the points of a cell fade: it belongs to the fall through a cell, and so knows
// neither the step nor the stiffness (docs/theory/mpm.md).
double Solver::Impl::settling_rate(const Vec2& gravity) const {
  return fades_in_fall * std::sqrt(gravity.norm() / std::sqrt(g.grid.spacing.prod()));
}

Solver::Impl::Cycle Solver::Impl::begin_step(double dt) {
  Cycle c{dt, leaps() ? 0.5 * (state.last_step + dt) : dt, choice.threads(), Vec2(0, 0), Vec2(0, 0)};
  choice.begin_step();
  impulses_before = state.impulses;
  g.join_strain_velocities();
  load(dt);
  c.gravity = loading.gravity(state.time);
  if (!options.pic_per_s && scheme.transfer == TransferKind::aflip) scheme.pic_per_s = settling_rate(c.gravity);
  if (work_in_steps()) c.moment = moment_of_mass();
  if (water) {
    water->set_time(state.time + 0.5 * dt);
    follow_level(c);
    if (state.steps % mass_every == 0) carry_water(c);
    if (water_works_in_steps()) potential_energy = water->potential_energy(p, c.gravity, c.threads);
  }
  return c;
}

void Solver::Impl::end_step(const Cycle& c) {
  add_work(c);
  if (!gather.good) fail("a particle is not finite or moved more than a cell in one step");
  state.fastest = std::sqrt(gather.fastest2);
  look_for_rest(c.dt);
  if (work_in_steps()) state.balance.gravity += c.gravity.dot(moment_of_mass() - c.moment);
  if (water && water_works_in_steps()) state.balance.gravity += potential_energy - water->potential_energy(p, c.gravity, c.threads);
  if (water && loading.gravity_changes())  // the fringe's energy goes with gravity
    state.balance.bodies += water->sums(p, loading.gravity(state.time + c.dt)).energy - water->sums(p, loading.gravity(state.time)).energy;
  if (leaps()) state.last_step = c.dt;
  ++state.steps;
  state.body_motion = bodies.motion();
  choice.end_step();
  change_densities(state.time + c.dt, true);
}

void Solver::Impl::find_cells(const Cycle& c) {
  wake_what_moves();
  if (restraints.tied().any()) {
    // (What is carried has its height again: no work of gravity.)
    const double before = water ? water->potential_energy(p, c.gravity, c.threads) : 0;
    restraints.tied().carry_over(state.time, p);
    if (water) state.balance.bodies += water->potential_energy(p, c.gravity, c.threads) - before;
    g.relocation.done = false;
  }
  std::vector<std::uint32_t> left;
  if (locate_points(p, g, left, c.threads)) {
    for (const std::uint32_t k : left) end_particle(k, EndReason::left_grid);
    g.follow(p, g.relocation.moves);
    state.since_sort += std::int64_t(g.relocation.moves.size());
    if (double(state.since_sort) > sort_share * double(p.size())) {
      p.sort_as(g.cells.order, c.threads);
      state.since_sort = 0;
    }
  }
  let_sleep();
}

// Nothing asks for the mapped velocity before the momentum is updated: A.3-A.7 in one sweep.
bool Solver::Impl::maps_and_advances() const {
  return scheme.stress != StressUpdate::usf && scheme.transfer != TransferKind::xpic && contacts.empty() && !pushes() &&
         !scheme.axisymmetric && !has_inertia();
}

// The greatest traction over the least Young's modulus.
double Solver::Impl::load_strain() const {
  double load = 0, young = std::numeric_limits<double>::infinity();
  for (const auto& [name, boundary] : scene.boundaries)
    if (boundary.type == BoundaryType::traction && boundary.traction_pa)
      load = std::max(load, std::hypot((*boundary.traction_pa)[0], (*boundary.traction_pa)[1]));
  for (const auto& material : materials)
    if (material->elastic().young > 0) young = std::min(young, material->elastic().young);
  return load / young;
}

SmallMassNodes::Rule Solver::Impl::small_nodes() const {
  const bool gains = water && scheme.transfer == TransferKind::flip;  // nodes that go on linearly drive FLIP's noise in full pores
  const bool loaded = scheme.stress == StressUpdate::usl && loading.tractions().any() && !gains;
  const double share = water && scheme.shape == ShapeKind::bilinear ? least_linear_mass
                       : !loaded                                    ? least_mass
                       : water ? std::clamp(load_strain() * load_strain() / 8, least_mass, least_loaded_mass)
                               : least_loaded_mass;
  return {share * least_density() * g.grid.spacing.prod(), loaded};
}

void Solver::Impl::map_to_nodes(const Cycle& c) {
  const SmallMassNodes::Rule small = small_nodes();
  const bool with_force = scheme.stress != StressUpdate::usf;
  if (with_force) flow_water(c);
  if (with_force) heat_points(c);
  if (with_force) average_mean_stress(p, g, scheme, c.threads);
  if (maps_and_advances()) return map_and_update(p, g, scheme, small_mass, small, c.gravity, c.push, c.threads);
  map_momentum(p, g, scheme, with_force, c.threads);
  small_mass.find(g, small);
  if (!contacts.empty()) contacts.find(p, g, density, c.dt, c.threads);
}

void Solver::Impl::strain_first(const Cycle& c) {
  if (scheme.stress != StressUpdate::usf) return;
  take_mapped_velocity(c);
  small_mass.join_velocity(g);
  strain(c);
  flow_water(c);
  heat_points(c);
  average_mean_stress(p, g, scheme, c.threads);
  map_force(p, g, scheme, c.threads);
}

// The mapped velocity, as walls and bodies let it be, gives the strain increments.
void Solver::Impl::take_mapped_velocity(const Cycle& c) {
  for_nodes(g, c.threads, [](Node& node, std::uint32_t) {
    node.nx = node.vx;
    node.ny = node.vy;
  });
  apply_restraints(c, false);  // (what walls do to the momentum is counted below)
  for_nodes(g, c.threads, [this](Node& node, std::uint32_t n) {
    const GridState::StrainVelocity u = g.strain_velocity(n);
    u.x = node.nx;
    u.y = node.ny;
    node.held_x = node.held_y = false;
  });
}

void Solver::Impl::advance_nodes(const Cycle& c) {
  if (!maps_and_advances()) {
    if (scheme.transfer == TransferKind::xpic) filtered_velocity(p, g, scheme.xpic_order, c.threads);
    map_loads(c.push, c.threads);
    if (has_inertia()) water->push_nodes(g);
    update_momentum(g, c.gravity, scheme.damping, c.push, c.threads);
    turn_by_coriolis(c);
  }
  if (steps_by_arrangement() && state.steps % arrangement_every == 0) state.own_frequency2 = held_frequency2(state.own_frequency2, own_frequency2(p, g, c.threads));
  small_mass.join_momentum(g, scheme.damping, c.push);
}

void Solver::Impl::restrain_nodes(const Cycle& c) {
  apply_restraints(c, true);
  if (has_inertia()) state.balance.darcy += water->accelerates(g, c.dt, state.water_inertia);
  bodies.advance(c.dt);
  if (scheme.stress == StressUpdate::usl) restrain_strain_velocity();
}

void Solver::Impl::apply_restraints(const Cycle& c, bool counted) {
  reactions.clear();
  if (water) press_faces(c, counted);
  restraints.apply(state.time, c.push, g, reactions, counted ? impulses_of_walls() : std::span<Impulse>());
  contacts.apply(g, restraints, reactions, counted ? impulses_of_contacts() : std::span<Impulse>());
  bodies.accelerate(state.time, c.push, c.gravity, field_of_bodies());
  const auto in_pores = [&](const std::vector<std::uint32_t>& nodes) {
    std::vector<double> pressures;
    for (const PoreWater::Thrust& t : water->thrust(p, g, c.gravity, state.time, nodes, c.threads)) pressures.push_back(t.pressure);
    return pressures;
  };
  bodies.apply(state.time, c.dt, touched_share * least_density() * g.grid.spacing.prod(), small_mass.pairs, p, g, reactions,
               water ? RigidBodies::Pressures(in_pores) : RigidBodies::Pressures());
  if (sleep.any()) sleep.hold(push_per_mass(c.push), g);
}

void Solver::Impl::restrain_strain_velocity() {
  small_mass.join_velocity(g);
  bodies.separate_strain_velocities(g);
  restraints.apply_to_strain_velocity(state.time, g);
  if (scheme.stress == StressUpdate::musl) contacts.apply_to_strain_velocity(g);
  bodies.apply_to_strain_velocity(state.time, g);
  sleep.hold_strain_velocity(g);
}

// (Where one sweep does both, strain_last() moves them.)
void Solver::Impl::move_points(const Cycle& c) {
  if (!moves_with_strain(g, scheme)) gather = gather_velocity(p, g, scheme, c.dt, c.threads);
  if (scheme.stress == StressUpdate::musl) restrain_strain_velocity();
}

void Solver::Impl::strain_last(const Cycle& c) {
  if (scheme.stress != StressUpdate::usf) strain(c, moves_with_strain(g, scheme) ? &gather : nullptr);
}

void Solver::Impl::strain(const Cycle& c, GatherSums* moved) {
  state.balance.damping += strain_and_update_stress(materials, p, g, scheme, c.dt, c.threads, moved);
  if (state.steps % stiffness_every == 0) take_wave_speed(c.threads);
}

}  // namespace pivnp::mpm

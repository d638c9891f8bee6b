#include "mpm/solver/solver.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/material/model.hpp"
#include "mpm/scene/memory.hpp"
#include "mpm/solver/frames.hpp"
#include "mpm/solver/impl.hpp"
#include "mpm/step/initial_equilibrium.hpp"
#include "mpm/step/own_frequency.hpp"
#include "mpm/step/time_step.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

// Steps between looks at the energy balance: at first more often, so that what was turned over in a first swing is seen.
constexpr std::int64_t check_every = 100, check_early = 10;

// Where mpm.equilibrium_tolerance is left out: of dry material, and what is sought beside water at rest.
constexpr double rough_balance = 1e-3, fine_balance = 1e-7;

// Share of the points that may stand open in an equilibrium that is sought with averages.
constexpr double few_open = 0.05;

bool has_reaction(const std::string& name, const BoundaryOptions& boundary) {
  return boundary.type != BoundaryType::tied && name != axis_boundary;
}

// (What take_pores() has taken out of the materials, the soils have.)
SceneNeeds needs_with_pores(const Scene& scene, const std::vector<PoreSoil>& pores) {
  SceneNeeds needs = needs_of(scene);
  needs.soils = needs.water && (scene.water->properties == WaterProperties::by_temperature ||
                                std::any_of(pores.begin(), pores.end(), [](const PoreSoil& s) { return s.kozeny_carman; }));
  return needs;
}

// Elements of water and of heat have their nodes in the lattice.
bool flows_in(const Scene& scene, const std::vector<PoreSoil>& pores) {
  return scene.water && std::any_of(pores.begin(), pores.end(), [](const PoreSoil& s) { return s.holds_water(); });
}

}  // namespace

Solver::Impl::Impl(const MpmOptions& o, Scene s, int n_threads)
    : options(o),
      scheme(scheme_of(o)),
      most_threads(std::max(1, n_threads)),
      choice(n_threads),
      scene(checked(o, std::move(s))),
      warm(take_heat(o, scene)),
      pores(take_pores(o, scene)),
      materials(materials_of(scene)),
      density(densities_of(scene)),
      contacts(scene.contacts, scene.particles.label_names),
      g(scene.grid, scheme.shape, contacts.velocity_fields(), scheme.stress == StressUpdate::usl,
        node_needs(scheme, materials, needs_with_pores(scene, pores)), scheme.axisymmetric),
      restraints(
          scene.boundaries, g, centroid(scene.particles),
          [this](const Vec2& x) { return impedance_near(scene, materials, undrained_stiffness(), x); },
          !scene.heat && !flows_in(scene, pores)),
      bodies(scene.bodies, g.field_grid, contacts.velocity_fields()),
      loading(o, scene),
      reduction(scene.materials.size(), 1.0),
      nonlocal(materials, g) {
  const Vec2 gravity = gravity_at_rest();
  fill_up_to_walls(restraints.walls(), g, scene.particles);
  bodies.check_clear(scene.particles.x0);
  for (const auto& [name, boundary] : scene.boundaries)
    if (boundary.grips) bodies.grip(name, boundary, centroid(scene.particles));
  if (scheme.stress == StressUpdate::usf && bodies.any_free())
    throw InputError("mpm.stress_update: found 'usf' beside a free rigid body, expected musl or usl");
  if (o.initial_equilibrium && gravity.norm() > 0 && restraints.any_absorbing())
    throw InputError("mpm.initial_equilibrium: found true beside an absorbing wall, which carries no weight; expected initial_equilibrium = false");
  if (restraints.tied().any() && !contacts.empty())
    throw InputError("contact." + scene.contacts.front().first + ": given beside a tied boundary, expected one of them");
  if (o.sleep_below_m_s && (restraints.tied().any() || !contacts.empty()))
    throw InputError(std::string("mpm.sleep_below_m_s: given beside ") + (contacts.empty() ? "a tied boundary" : "a [contact.NAME]") +
                     ", expected none: bodies in contact would not wake");
  state = initial_state(scene, scheme, g, materials, contacts);
  least_turned_over = least_turnover(p, materials, loading.greatest_gravity_at(centroid(scene.particles)), g.grid.spacing.minCoeff());
  sleep.start(p, g);
  g.rebuild(p);
  p.sort_as(g.cells.order, 1);
  set_walls(0);
  fill_pores();
  start_heat();
  take_wave_speed(1);
  start_sleep();
  if (steps_by_arrangement()) state.own_frequency2 = own_frequency2_at_start(p, g);
  if (o.k0 && !scene.stress0.empty()) throw InputError("mpm.k0: given together with a stress at the start, expected one of them");
  if (o.k0 && !o.initial_equilibrium) start_at_rest(gravity);
  change_strength(0);
  state.body_motion = bodies.motion();
  state.impulses.assign(restraints.walls().size() + scene.boundaries.size() + bodies.size() + scene.contacts.size(), {});
  restart_balance();
}

bool Solver::Impl::steps_by_arrangement() const {
  return !options.courant && mpm::steps_by_arrangement(scheme, !bodies.empty() || !scene.contacts.empty(), bool(water));
}

double Solver::Impl::courant() const {
  return steps_by_arrangement() ? courant_of(state.own_frequency2) : options.courant.value_or(least_courant);
}

double Solver::Impl::longest_step() const {
  const double fastest = std::max(state.fastest, bodies.fastest());
  const double of_waves =
      water ? stable_step_with_water(courant(), g.grid.spacing.x(), g.grid.spacing.y(), state.wave_speed, fastest,
                                     flows_in_parts ? 0 : state.diffusivity)
            : mpm::stable_step(courant(), g.grid.spacing.minCoeff(), state.wave_speed, fastest);
  return heat ? std::min(of_waves, courant() * heat->longest_step(g)) : of_waves;
}

void Solver::Impl::set_walls(double time) {
  g.set_walls(restraints.wall_sides(time, g.grid, false), restraints.wall_sides(time, g.grid, true),
              restraints.node_shifts(time, g.grid));
}

double Solver::Impl::next_change(double time) const {
  return std::min({restraints.next_change(time), bodies.next_change(time), loading.next_change(time)});
}

Solver::Solver(const MpmOptions& options, Scene scene, int threads)
    : impl_(std::make_unique<Impl>(options, std::move(scene), threads)) {}
Solver::~Solver() = default;

void Solver::find_initial_equilibrium(Progress& progress) {
  Impl& s = *impl_;
  if (s.state.steps > 0) throw RunError("mpm: find_initial_equilibrium() was called after the first step");
  for (const auto& material : s.materials)
    if (material->from_deformation())
      throw InputError("mpm.initial_equilibrium: found true beside " + material->name() +
                       ", which takes no stress at the start; expected false");
  // The average of three-node shapes leaves a point's own mean stress free to drift where points open one by one.
  Scheme scheme = s.scheme;
  if (scheme.shape != ShapeKind::bilinear) scheme.locking = Locking::none;
  const double tolerance = s.options.equilibrium_tolerance.value_or(rough_balance);
  const bool sought_on = s.water && !s.options.equilibrium_tolerance;
  EquilibriumOptions options{s.gravity_at_rest(), s.options.equilibrium_damping, tolerance, sought_on ? fine_balance : tolerance, s.most_threads,
                             s.options.k0, s.scene.stress0, s.variation_of_gravity()};
  const StaticSystem system{scheme, s.materials, s.density, s.restraints, s.contacts, s.bodies, s.p, s.g, s.scene.particles, s.water.get()};
  const bool with_averages = s.water && scheme.locking != s.scheme.locking;
  options.leads_on = with_averages;
  const bool moves_on = relax_to_equilibrium(options, system, progress) < 0;
  const bool balanced = with_averages && s.balance_averages(options, scheme, system, progress);
  if (moves_on && !balanced)
    throw RunError(
        "initial equilibrium: the forces are balanced but the material goes on moving (is it strong enough to carry "
        "its weight? "
        "mpm.initial_equilibrium = false starts without)");
  s.p.resize_increments(0);
  s.p.history.reset();
  s.restart_balance();
}

// What the averages change of an equilibrium without them moves soil beside water at rest: it is brought to rest with
// them, from there, unless more than a few points open (they take no part in averages) or that finds no end (false).
bool Solver::Impl::balance_averages(EquilibriumOptions o, Scheme& used, const StaticSystem& system,
                                    Progress& progress) {
  const std::array<Array*, 4> stress{&p.tau_xx, &p.tau_yy, &p.tau_zz, &p.tau_xy};
  std::array<Array, 4> found;
  for (std::size_t c = 0; c < stress.size(); ++c) found[c] = *stress[c];
  const auto many_open = [this] {
    const Array* opening = p.history.find(opening_strain.name);
    return opening && double(std::ranges::count_if(*opening, [](double strain) { return strain > 0; })) >
                          few_open * double(p.size());
  };
  if (many_open()) return false;
  o.goes_on = true;
  o.leads_on = false;
  o.given = {};
  used.locking = scheme.locking;
  bool settled = true;
  try {
    relax_to_equilibrium(o, system, progress);
  } catch (const RunError&) {
    settled = false;
  }
  if (settled && !many_open()) return true;
  for (std::size_t c = 0; c < stress.size(); ++c) *stress[c] = found[c];
  water->refresh(p, o.gravity, most_threads);
  return false;
}

void Solver::require_held() const {
  const Impl& s = *impl_;
  if (s.bodies.size() == 0)  // what those hold is known once they have met it
    mpm::require_held(s.p, s.g, s.restraints, {}, s.gravity_at_rest(), s.scene.particles);
}

void Solver::advance_to(double time, Progress& progress) {
  Impl& s = *impl_;
  if (s.failed) throw RunError("mpm: advance_to() was called after the run had failed");
  while (s.state.time < time) {
    if ((s.state.at_rest && s.options.end_at_rest) || s.state.far) {
      s.state.not_stepped += time - s.state.time;
      s.state.time = time;
      return;
    }
    const double stop = std::min(time, s.next_change(s.state.time));
    const double longest = s.longest_step(), dt = trimmed_step(s.state.time, stop, longest);
    const double before = s.state.time;
    s.heat_due = stop == time && time - s.state.time <= longest;
    s.step(dt);
    s.state.time = stop - s.state.time <= longest ? stop : s.state.time + dt;
    if (s.forces_jump(s.state.time)) s.catch_up();
    if (s.state.time == s.next_change(before)) s.sleep.wake_all();
    if (s.state.time == s.restraints.next_change(before)) s.set_walls(s.state.time);
    if (s.observer) s.observer(dt, [&s](const Vec2& x) { return velocity_at(s.g, x); });
    if (s.state.steps < check_every && s.state.steps % check_early == 0) s.check_balance();
    if (s.state.steps % check_every == 0) {
      s.check_balance();
      s.watch_motion();
      if ((s.state.at_rest && s.options.end_at_rest) || s.state.far) s.catch_up();
      progress.update("mpm", s.state.steps, s.state.steps + std::int64_t(std::ceil((time - s.state.time) / dt)));
      if (progress.stop_requested()) throw Interrupted();
    }
  }
  s.take_work();
  s.check_balance();
}

double Solver::time() const { return impl_->failed ? impl_->good.energy.time : impl_->state.time; }
std::int64_t Solver::steps() const { return impl_->failed ? impl_->good.steps : impl_->state.steps; }
double Solver::stable_step() const { return impl_->longest_step(); }
Vec2 Solver::momentum() const {
  const Particles& p = impl_->p;
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass_of(k) * Vec2(p.vx[k], p.vy[k]);
  return sum + pushed_momentum(p, impl_->g, impl_->last);
}
EnergyRow Solver::energy() const { return impl_->failed ? impl_->good.energy : impl_->energy_now(); }
bool Solver::at_rest() const { return impl_->state.at_rest; }
Vec2 Solver::body_displacement(std::size_t body) const {
  return impl_->bodies.displacement(body, impl_->state.time);
}
double Solver::body_mass(std::size_t body) const { return impl_->bodies.mass(body, impl_->state.time); }
Vec2 Solver::body_impulse(std::size_t body) const {
  const Impulse impulse = impl_->impulse_now(impl_->restraints.walls().size() + impl_->scene.boundaries.size() + body);
  return {impulse.x, impulse.y};
}

std::vector<std::string> Solver::reaction_names() const {
  std::vector<std::string> names;
  for (const auto& [name, boundary] : impl_->scene.boundaries)
    if (has_reaction(name, boundary)) names.push_back("boundary." + name);
  for (const auto& [name, body] : impl_->scene.bodies) names.push_back("body." + name);
  for (const auto& [name, contact] : impl_->scene.contacts) names.push_back("contact." + name);
  return names;
}

ReactionRow Solver::reactions() const {
  Impl& s = *impl_;
  ReactionRow row{.time = s.state.time, .stepped = s.state.time - s.state.not_stepped, .of = {}};
  const auto add = [&](const Impulse& i, const Vec2& displacement, double turn) {
    row.of.push_back({{i.x, i.y}, i.moment, displacement, turn});
  };
  const std::vector<Wall>& walls = s.restraints.walls();
  const std::size_t tractions = walls.size(), of_bodies = tractions + s.scene.boundaries.size(), of_contacts = of_bodies + s.bodies.size();
  for (std::size_t b = 0; b < s.scene.boundaries.size(); ++b) {
    const auto& [name, boundary] = s.scene.boundaries[b];
    if (!has_reaction(name, boundary)) continue;
    std::size_t at = tractions + b;
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (walls[w].key == "boundary." + name) at = w;
    const int body = s.bodies.gripping(name);
    if (body < 0) add(s.impulse_now(at), Vec2::Zero(), 0);
    else add(s.impulse_now(of_bodies + std::size_t(body)), s.bodies.displacement(std::size_t(body), s.state.time), 0);
  }
  for (std::size_t b = 0; b < s.scene.bodies.size(); ++b)
    add(s.impulse_now(of_bodies + b), s.bodies.displacement(b, s.state.time), s.bodies.turn(b, s.state.time));
  for (std::size_t k = 0; k < s.scene.contacts.size(); ++k) add(s.impulse_now(of_contacts + k), Vec2::Zero(), 0);
  return row;
}
Solver::Slept Solver::slept() const {
  const SleepState& s = impl_->state.sleep;
  const double longest = s.foregone.empty() ? 0 : *std::max_element(s.foregone.begin(), s.foregone.end());
  return {s.all > 0 ? s.skipped / s.all : 0, longest + s.held_back, s.energy};
}
const std::string& Solver::pressure_choice() const { return impl_->pressure_choice; }
std::size_t Solver::ended() const {
  const auto& cells = impl_->p.cell;
  return std::size_t(std::count(cells.begin(), cells.end(), Particles::ended));
}

const ParticleSet& Solver::particles() const {
  return impl_->scene.particles;
}

MotionFrame Solver::frame() const {
  if (impl_->failed) throw RunError("mpm: frame() was called after the run had failed");
  MotionFrame frame = frame_of(impl_->state, impl_->scene.particles);
  impl_->bring_to_time(frame);
  if (impl_->water) impl_->put_water(frame);
  if (impl_->heat) impl_->put_heat(frame);
  return frame;
}

void Solver::on_step(std::function<void(double dt, const VelocityAt&)> observer) {
  impl_->observer = std::move(observer);
}

std::vector<std::byte> Solver::save() const {
  if (impl_->failed) throw RunError("mpm: save() was called after the run had failed");
  return to_bytes(impl_->state);
}

void Solver::load(const std::vector<std::byte>& checkpoint) {
  const std::vector<SolverState::Ended> ended = impl_->state.ended;
  from_bytes(checkpoint, impl_->state);
  impl_->restore_ends(ended);
  impl_->g.rebuild(impl_->p);
  impl_->set_walls(impl_->state.time);
  impl_->bodies.set_motion(impl_->state.body_motion);
  impl_->change_densities(impl_->state.time, false);
  impl_->change_strength(impl_->state.time);
  impl_->sleep.resume(impl_->g);
  impl_->failed = false;
  impl_->last = {};
  impl_->good = {impl_->energy(), impl_->state.steps};
}

}  // namespace pivnp::mpm

#include "mpm/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mpm/boundary.hpp"
#include "mpm/loading.hpp"
#include "mpm/momentum.hpp"
#include "mpm/rigid_body.hpp"
#include "mpm/scene_setup.hpp"
#include "mpm/settle.hpp"
#include "mpm/solver_state.hpp"
#include "mpm/thread_choice.hpp"
#include "mpm/time_step.hpp"
#include "mpm/transfer.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t check_every = 100;     // steps between looks at the energy balance
constexpr std::int64_t stiffness_every = 8;   // steps between looks at the wave speed
constexpr double sort_share = 0.1;            // of the points that may change cells between re-sorts of the storage
constexpr double least_mass = 1e-5;           // of a full cell: lighter nodes move with a neighbour
constexpr double heavy_mass = 0.05;           // of a full cell: nodes whose speed says something
constexpr double touching = 0.25;             // of a full cell: mass around a body's outline in contact
constexpr double calm = 1e-3;                 // of the peak kinetic energy
constexpr double calm_share = 0.1;            // of the run for which it has to be calm, and
constexpr int calm_looks = 10;                // looks at the balance
constexpr double still = 0.01;                // cells that the fastest node may still go in the time run so far

}  // namespace

// What stays readable after a failure: the last state that passed check_balance().
struct LastGood {
  MotionFrame frame;
  EnergyRow energy;
  std::int64_t steps = 0;
};

struct Solver::Impl {
  Impl(const MpmOptions& o, Scene s, int n_threads)
      : options(o),
        scheme(scheme_of(o)),
        most_threads(std::max(1, n_threads)),
        choice(n_threads),
        scene(std::move(s)),
        materials(materials_of(scene)),
        density(densities_of(scene)),
        g(scene.grid, scheme.shape),
        restraints(scene.boundaries, g, centroid(scene.particles),
                   [this](const Vec2& x) { return impedance_near(scene, materials, x); }),
        bodies(scene.bodies, g.grid),
        loading(o, scene),
        reduction(scene.materials.size(), 1.0) {
    const Vec2 gravity = loading.gravity(0);
    bodies.check_clear(scene.particles.x0);
    if (scheme.stress == StressUpdate::usf && bodies.any_free())
      throw InputError("mpm.stress_update: found 'usf' beside a free rigid body, expected musl or usl");
    if (o.settle && gravity.norm() > 0 && restraints.any_absorbing())
      throw InputError("mpm.settle: found true beside an absorbing wall, which carries no weight; expected settle = false");
    state = initial_state(scene, scheme, g, materials);
    place_tractions();
    g.rebuild(p);
    p.sort_as(g.order, 1);
    state.wave_speed = wave_speed(materials, density, p);
    g.set_folds(restraints.folds(0, g.grid));
    if (o.k0 && !o.settle) start_at_rest(gravity);
    change_strength(0);
    state.body_motion = bodies.motion();
    restart_books();
  }

  void step(double dt);
  void find_cells(int threads);
  void restrain_momentum(double dt);
  void restrain_velocity();
  void map_state(double dt, int threads);
  void map_body_force(int threads);
  void load(double dt);
  void change_densities(double time, bool book);
  void change_strength(double time);
  void remove_due();
  void start_at_rest(const Vec2& gravity);
  void place_tractions();
  bool pushes() const { return scene.body_force || !loading.pushed().empty(); }
  bool work_in_steps() const { return loading.gravity_changes() || loading.any_density(); }
  Vec2 moment_of_mass() const;
  void choose_strain_velocity(double dt);
  void strain(double dt, int threads);
  void book_work(double dt);
  void watch_motion();
  bool moved_far() const;
  double least_density() const { return *std::min_element(density.begin(), density.end()); }
  void end_particles(const std::vector<std::uint32_t>& left);
  void check_balance();
  void keep(const EnergyRow& row);
  [[noreturn]] void fail(const std::string& cause);
  void restart_books();
  double longest_step() const;
  double work_of_gravity() const;
  EnergyRow energy();

  MpmOptions options;
  Scheme scheme;
  int most_threads;
  ThreadChoice choice;
  Scene scene;
  Materials materials;
  std::vector<double> density;
  GridState g;
  Restraints restraints;
  RigidBodies bodies;
  Loading loading;
  std::vector<double> reduction;  // by which the materials' strengths are divided now
  std::vector<std::int32_t> pushed_at;  // of every particle: its entry in Loading::pushed(); -1: none
  SolverState state;
  LastGood good;
  bool failed = false;  // only `good` is meant any more
  Particles& p = state.particles;
  GatherSums gather;
  LightNodes light;
  std::vector<double> filtered, pushed;  // x, y of every node: XPIC's velocity, Scene::body_force
  std::vector<Reaction> reactions;
  std::function<void(double, const VelocityAt&)> observer;
};

// The cycle of appendix A; equation numbers are the thesis'.
void Solver::Impl::step(double dt) {
  const int threads = choice.threads();
  choice.begin_step();
  load(dt);
  const Vec2 gravity = loading.gravity(state.time + 0.5 * dt);
  const Vec2 moment = work_in_steps() ? moment_of_mass() : Vec2(0, 0);

  find_cells(threads);                                           // A.1, A.2
  map_state(dt, threads);                                        // A.3, A.4
  map_body_force(threads);
  update_momentum(g, gravity, scheme.damping, dt, threads);      // A.5-A.7
  light.join_momentum(g, dt);
  restrain_momentum(dt);
  bodies.advance(dt);
  gather = gather_velocity(p, g, scheme, dt, filtered, scheme.stress == StressUpdate::musl, threads);  // A.8-A.11
  if (scheme.stress == StressUpdate::usf) {
    book_work(dt);
  } else {
    choose_strain_velocity(dt);
    book_work(dt);
    strain(dt, threads);                                         // A.12, A.13, A.22, A.24
  }

  if (!gather.good) fail("a particle is not finite or moved more than a cell in one step");
  state.fastest = std::sqrt(gather.fastest2);
  if (work_in_steps()) state.book.gravity += gravity.dot(moment_of_mass() - moment);
  ++state.steps;
  state.body_motion = bodies.motion();
  choice.end_step();
}

void Solver::Impl::map_state(double dt, int threads) {
  const bool first = scheme.stress == StressUpdate::usf;
  if (!first) average_mean_stress(p, g, scheme, threads);
  map_momentum(p, g, scheme, !first, threads);
  light.find(g, least_mass * least_density() * g.grid.spacing.prod());
  if (first) {
    choose_strain_velocity(dt);
    strain(dt, threads);  // A.12, A.13, A.22, A.24
    average_mean_stress(p, g, scheme, threads);
    map_force(p, g, scheme, threads);
  }
  if (scheme.transfer == TransferKind::xpic) filtered_velocity(p, g, scheme.xpic_order, filtered, threads);
}

void Solver::Impl::choose_strain_velocity(double dt) {
  const bool first = scheme.stress == StressUpdate::usf;
  if (first) {  // the mapped velocity, as walls and bodies let it be
    for (const std::uint32_t n : g.nodes) {
      g.node[n].nx = g.node[n].vx;
      g.node[n].ny = g.node[n].vy;
    }
    restrain_momentum(dt);
  }
  if (scheme.stress != StressUpdate::musl)
    for (const std::uint32_t n : g.nodes) {
      Node& node = g.node[n];
      node.ux = node.nx;
      node.uy = node.ny;
      if (first) node.held = false;
    }
  light.join_velocity(g);
  if (!first) restrain_velocity();
}

void Solver::Impl::strain(double dt, int threads) {
  strain_and_update_stress(materials, p, g, scheme, dt, threads);
  if (state.steps % stiffness_every == 0) state.wave_speed = wave_speed(materials, density, p);
}

void Solver::Impl::map_body_force(int threads) {
  if (!pushes()) return;
  std::vector<double> ax(p.size()), ay(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    Vec2 a(0, 0);
    if (scene.body_force && p.cell[k] != Particles::ended) a = scene.body_force(p.index[k], state.time);
    const std::int32_t push = pushed_at.empty() ? -1 : pushed_at[p.index[k]];
    if (push >= 0 && p.cell[k] != Particles::ended) {
      const Loading::Pushed& load = loading.pushed()[std::size_t(push)];
      const double mass_then = p.volume0[k] * scene.materials[std::size_t(scene.particles.label[p.index[k]])].density_kg_m3;
      a += load.share(state.time) * mass_then / p.mass[k] * load.acceleration;
    }
    ax[k] = a.x();
    ay[k] = a.y();
  }
  map_acceleration(p, g, ax, ay, pushed, threads);
}

// What changes by the case's will, before a step: densities and strengths as at its end, material taken out by its start.
void Solver::Impl::load(double dt) {
  if (loading.any_density()) change_densities(state.time + dt, true);
  change_strength(state.time + dt);
  remove_due();
}

// Mass that comes moves as the point does: its kinetic energy is work done from outside.
void Solver::Impl::change_densities(double time, bool book) {
  if (!loading.any_density()) return;
  for (const Particles::Body& body : p.bodies) {
    const auto material = std::size_t(body.material);
    const double now = scene.materials[material].density_kg_m3 * loading.density_ratio(material, time);
    density[material] = now;
    if (!book) continue;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      const double mass = p.volume0[k] * now;
      if (mass == p.mass[k] || p.cell[k] == Particles::ended) continue;
      const double before = stored_kinetic(p, g, k);
      p.mass[k] = mass;
      state.book.bodies += stored_kinetic(p, g, k) - before;
    }
  }
}

void Solver::Impl::change_strength(double time) {
  if (!loading.any_reduction()) return;
  std::vector<MaterialOptions> now = scene.materials;
  bool changed = false;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const double factor = loading.reduction(k, time);
    changed = changed || factor != reduction[k];
    reduction[k] = factor;
    now[k] = Loading::reduced(now[k], factor);
  }
  if (changed) materials = materials_of(scene, now);
}

void Solver::Impl::remove_due() {
  bool any = false;
  for (const Particles::Body& body : p.bodies) {
    if (loading.removal(std::size_t(body.material)) > state.time) continue;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      if (p.cell[k] == Particles::ended) continue;
      state.end[p.index[k]] = state.time;
      state.end_reason[p.index[k]] = EndReason::removed;
      const StoredEnergy lost = stored_energy_of(p, g, materials, k);
      state.book.carried += lost.kinetic + lost.elastic;
      p.cell[k] = Particles::ended;
      any = true;
    }
  }
  if (any) g.rebuild(p);
}

void Solver::Impl::start_at_rest(const Vec2& gravity) {
  if (std::abs(gravity.x()) > 1e-3 * std::abs(gravity.y()))
    throw InputError("mpm.k0: given where gravity is not vertical, expected settle = true without it");
  stress_from_columns(p, materials, g, gravity.y(), options.k0);
}

void Solver::Impl::place_tractions() {
  if (loading.pushed().empty()) return;
  pushed_at.assign(scene.particles.size(), -1);
  for (std::size_t k = 0; k < loading.pushed().size(); ++k) {
    std::int32_t& at = pushed_at[loading.pushed()[k].particle];
    if (at >= 0) throw InputError("boundary: two tractions load the same particle, expected faces apart");
    at = std::int32_t(k);
  }
}

Vec2 Solver::Impl::moment_of_mass() const {
  Vec2 sum(0, 0);
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass[k] * Vec2(p.x[k], p.y[k]);
  return sum;
}

void Solver::Impl::find_cells(int threads) {
  std::vector<std::uint32_t> left;
  if (!locate_points(p, g, left, threads)) return;
  end_particles(left);
  g.follow(p, g.moved);
  state.since_sort += std::int64_t(g.moved.size());
  if (double(state.since_sort) <= sort_share * double(p.size())) return;
  p.sort_as(g.order, threads);
  state.since_sort = 0;
}

void Solver::Impl::restrain_momentum(double dt) {
  reactions.clear();
  restraints.apply(state.time, dt, g, reactions);
  bodies.accelerate(state.time, dt, loading.gravity(state.time + 0.5 * dt));
  bodies.apply(state.time, touching * least_density() * g.grid.spacing.prod(), g, reactions);
}

void Solver::Impl::restrain_velocity() {
  restraints.apply_to_remapped(state.time, g);
  bodies.apply_to_remapped(state.time, g);
}

void Solver::Impl::book_work(double dt) {
  const bool strained = scheme.stress != StressUpdate::usf;
  state.book.add(nodal_work(g, reactions, scheme.damping, dt, strained), gather.kinetic_loss);
  for (const Reaction& r : reactions)
    if (r.body >= 0) {
      state.body_impulse[2 * std::size_t(r.body)] += r.impulse_x;
      state.body_impulse[2 * std::size_t(r.body) + 1] += r.impulse_y;
    }
  if (!pushes()) return;
  for (const std::uint32_t n : g.nodes) {
    const Vec2 w = working_velocity(g.node[n], strained);
    const double work = dt * (pushed[2 * n] * w.x() + pushed[2 * n + 1] * w.y());
    state.book.bodies += work;
    state.book.moved += std::abs(work);
  }
}

void Solver::Impl::watch_motion() {
  const NodalMotion motion = nodal_motion(g, heavy_mass * least_density() * g.grid.spacing.prod());
  state.peak_kinetic = std::max(state.peak_kinetic, motion.kinetic);
  const bool is_calm = motion.kinetic < calm * state.peak_kinetic &&
                       std::sqrt(motion.fastest2) * state.time < still * g.grid.spacing.minCoeff();
  if (!is_calm) {
    state.calm_since = state.time;
    state.calm_looks = 0;
  }
  state.far = moved_far();
  state.at_rest = is_calm && ++state.calm_looks > calm_looks && !scene.body_force &&
                  state.time - state.calm_since > calm_share * state.time &&
                  std::isinf(restraints.next_change(state.time)) && !loading.changing_after(state.time) && !bodies.moving_after(state.time);
}

bool Solver::Impl::moved_far() const {
  if (!options.end_displacement_m) return false;
  const double most2 = *options.end_displacement_m * *options.end_displacement_m;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies.mass(b, state.time) > 0 && bodies.displacement(b, state.time).squaredNorm() >= most2) return true;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended &&
        (Vec2(p.x[k], p.y[k]) - scene.particles.x0[p.index[k]]).squaredNorm() >= most2)
      return true;
  return false;
}

void Solver::Impl::end_particles(const std::vector<std::uint32_t>& left) {
  for (const std::uint32_t k : left) {
    state.end[p.index[k]] = state.time;
    state.end_reason[p.index[k]] = EndReason::left_grid;
    const StoredEnergy lost = stored_energy_of(p, g, materials, k);
    state.book.carried += lost.kinetic + lost.elastic;
  }
}

double Solver::Impl::longest_step() const {
  return mpm::stable_step(options.courant, g.grid.spacing.minCoeff(), state.wave_speed,
                     std::max(state.fastest, bodies.fastest()));
}

double Solver::Impl::work_of_gravity() const {
  double work = 0;
  const Vec2 gravity = loading.gravity(state.time);
  for (std::size_t k = 0; k < p.size(); ++k)
    work += p.mass[k] * gravity.dot(Vec2(p.x[k], p.y[k]) - scene.particles.x0[p.index[k]]);
  return work;
}

EnergyRow Solver::Impl::energy() {
  EnergyBook book = state.book;
  if (!work_in_steps()) book.gravity = work_of_gravity();
  EnergyRow row = energy_row(state.time, stored_energy(p, g, materials), book);
  if (scheme.shape == ShapeKind::bilinear) row.hourglass = hourglass_energy(p, g);
  return row;
}

void Solver::Impl::check_balance() {
  const EnergyRow row = energy();
  if (!std::isfinite(row.residual)) fail("the energy is not finite");
  const double turned_over = turnover(row, state.book);
  if (std::abs(row.residual) > options.energy_limit * turned_over) {
    std::ostringstream text;
    text << "the energy residual is " << row.residual << " J/m, beyond " << options.energy_limit
         << " of what was turned over (" << turned_over << " J/m; mpm.energy_limit)";
    fail(text.str());
  }
  keep(row);
}

// In single precision, as its readers get it: a copy of the whole state would double the memory.
void Solver::Impl::keep(const EnergyRow& row) {
  good = {frame_of(state, scene.particles), row, state.steps};
}

void Solver::Impl::fail(const std::string& cause) {
  std::ostringstream text;
  text << "mpm: at t = " << state.time << " s, step " << state.steps << ": " << cause << "; the state at t = "
       << good.frame.time << " s is the last good one";
  failed = true;
  throw RunError(text.str());
}

void Solver::Impl::restart_books() {
  state.book = EnergyBook{};
  const StoredEnergy stored = stored_energy(p, g, materials);
  state.book.start = stored.kinetic + stored.elastic;
  failed = false;
  keep(energy());
}

Solver::Solver(const MpmOptions& options, Scene scene, int threads)
    : impl_(std::make_unique<Impl>(options, std::move(scene), threads)) {}
Solver::~Solver() = default;

void Solver::settle(Progress& progress) {
  Impl& s = *impl_;
  if (s.state.steps > 0) throw RunError("mpm: settle() was called after the first step");
  for (const auto& material : s.materials)
    if (material->from_deformation())
      throw InputError("mpm.settle: found true beside neo_hookean, which takes no stress at the start; expected false");
  // The average of three-node shapes leaves a point's own mean stress free to drift where points open one by one.
  Scheme scheme = s.scheme;
  if (scheme.shape != ShapeKind::bilinear) scheme.locking = Locking::none;
  settle_particles({s.loading.gravity(0), s.options.settle_damping, s.options.settle_tolerance, s.most_threads, s.options.k0}, scheme,
                   s.materials, s.restraints, s.bodies, s.p, s.g, progress);
  s.p.resize_increments(0);
  for (auto* history : {&s.p.plastic_dev, &s.p.gap, &s.p.dissipated}) std::fill(history->begin(), history->end(), 0.0);
  std::fill(s.p.opened.begin(), s.p.opened.end(), std::uint8_t{0});
  s.restart_books();
}

void Solver::advance_to(double time, Progress& progress) {
  Impl& s = *impl_;
  if (s.failed) throw RunError("mpm: advance_to() was called after the run had failed");
  while (s.state.time < time) {
    if ((s.state.at_rest && s.options.end_at_rest) || s.state.far) {
      s.state.time = time;
      return;
    }
    const double stop = std::min({time, s.restraints.next_change(s.state.time), s.bodies.next_change(s.state.time),
                                  s.loading.next_change(s.state.time)});
    const double longest = s.longest_step(), dt = trimmed_step(s.state.time, stop, longest);
    const double before = s.state.time;
    s.step(dt);
    s.state.time = stop - s.state.time <= longest ? stop : s.state.time + dt;
    if (s.state.time == s.restraints.next_change(before)) s.g.set_folds(s.restraints.folds(s.state.time, s.g.grid));
    if (s.observer) s.observer(dt, [&s](const Vec2& x) { return s.g.velocity_at(x); });
    if (s.state.steps % check_every == 0) {
      s.check_balance();
      s.watch_motion();
      progress.update("mpm", s.state.steps, s.state.steps + std::int64_t(std::ceil((time - s.state.time) / dt)));
      if (progress.stop_requested()) throw Interrupted();
    }
  }
  s.check_balance();
}

double Solver::time() const { return impl_->failed ? impl_->good.frame.time : impl_->state.time; }
std::int64_t Solver::steps() const { return impl_->failed ? impl_->good.steps : impl_->state.steps; }
double Solver::stable_step() const { return impl_->longest_step(); }
Vec2 Solver::momentum() const {
  const Particles& p = impl_->p;
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass[k] * Vec2(p.vx[k], p.vy[k]);
  return sum;
}
EnergyRow Solver::energy() const { return impl_->failed ? impl_->good.energy : impl_->energy(); }
bool Solver::at_rest() const { return impl_->state.at_rest; }
Vec2 Solver::body_displacement(std::size_t body) const {
  return impl_->bodies.displacement(body, impl_->state.time);
}
double Solver::body_mass(std::size_t body) const { return impl_->bodies.mass(body, impl_->state.time); }
Vec2 Solver::body_impulse(std::size_t body) const {
  return {impl_->state.body_impulse.at(2 * body), impl_->state.body_impulse.at(2 * body + 1)};
}
std::size_t Solver::ended() const {
  const auto& cells = impl_->p.cell;
  return std::size_t(std::count(cells.begin(), cells.end(), Particles::ended));
}

const ParticleSet& Solver::particles() const {
  impl_->scene.particles.end = impl_->state.end;
  impl_->scene.particles.end_reason = impl_->state.end_reason;
  return impl_->scene.particles;
}

MotionFrame Solver::frame() const {
  return impl_->failed ? impl_->good.frame : frame_of(impl_->state, impl_->scene.particles);
}

void Solver::on_step(std::function<void(double dt, const VelocityAt&)> observer) {
  impl_->observer = std::move(observer);
}

std::vector<std::byte> Solver::save() const {
  if (impl_->failed) throw RunError("mpm: save() was called after the run had failed");
  return to_bytes(impl_->state);
}

void Solver::load(const std::vector<std::byte>& checkpoint) {
  from_bytes(checkpoint, impl_->state);
  impl_->g.rebuild(impl_->p);
  impl_->g.set_folds(impl_->restraints.folds(impl_->state.time, impl_->g.grid));
  impl_->bodies.set_motion(impl_->state.body_motion);
  impl_->change_densities(impl_->state.time, false);
  impl_->change_strength(impl_->state.time);
  impl_->failed = false;
  impl_->keep(impl_->energy());
}

}  // namespace pivnp::mpm

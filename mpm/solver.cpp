#include "mpm/solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mpm/boundary.hpp"
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
constexpr std::int64_t sort_every = 64;       // changes of cells between re-sorts of the storage
constexpr double largest_gain = 0.25;         // of the energy turned over; a loss is written, not fatal

}  // namespace

struct Solver::Impl {
  Impl(const MpmOptions& o, Scene s, int n_threads)
      : options(o),
        scheme(scheme_of(o)),
        most_threads(std::max(1, n_threads)),
        choice(n_threads),
        scene(std::move(s)),
        materials(materials_of(scene)),
        restraints(scene.boundaries, scene.grid, centroid(scene.particles)),
        bodies(scene.bodies, scene.grid),
        g(scene.grid),
        gravity(o.gravity_m_s2[0], o.gravity_m_s2[1]),
        wave_speed(fastest_wave(scene, materials)) {
    bodies.check_clear(scene.particles.x0);
    state = initial_state(scene);
    state.particles.sort_by_cell();
    g.rebuild(p);
    restart_books();
  }

  void step(double dt);
  void find_cells(int threads);
  void restrain_momentum();
  void restrain_velocity();
  void book_work(double dt);
  void end_particles(const std::vector<std::uint32_t>& left);
  void check_balance();
  [[noreturn]] void fail(const std::string& cause);
  void restart_books();
  double longest_step() const;
  double work_of_gravity() const;
  EnergyRow energy() const;

  MpmOptions options;
  Scheme scheme;
  int most_threads;
  ThreadChoice choice;
  Scene scene;
  Materials materials;
  Restraints restraints;
  RigidBodies bodies;
  GridState g;
  Vec2 gravity;
  double wave_speed;
  SolverState state;
  SolverState good;  // the last state that passed check_balance()
  Particles& p = state.particles;
  GatherSums gather;
  std::vector<Reaction> reactions;
  std::function<void(double, const VelocityAt&)> observer;
};

// The cycle of appendix A; equation numbers are the thesis'.
void Solver::Impl::step(double dt) {
  const double pic = 1 - std::exp(-scheme.pic_share * dt * wave_speed / g.grid.spacing.minCoeff());
  const int threads = choice.threads();
  choice.begin_step();

  find_cells(threads);                                           // A.1, A.2
  particles_to_grid(p, g, threads);                              // A.3, A.4
  update_momentum(g, gravity, scheme.damping, dt, threads);      // A.5-A.7
  restrain_momentum();
  gather = grid_to_particles(p, g, dt, pic, threads);            // A.8-A.11
  book_work(dt);
  restrain_velocity();
  strain_increments(p, g, dt, threads);                          // A.12
  update_deformation(p, threads);                                // A.13
  update_stress(materials, p, threads);                          // A.22, A.24

  if (!gather.good) fail("a particle is not finite or moved more than a cell in one step");
  state.fastest = std::sqrt(gather.fastest2);
  ++state.steps;
  choice.end_step();
}

void Solver::Impl::find_cells(int threads) {
  std::vector<std::uint32_t> left;
  if (!locate_points(p, g, left, threads)) return;
  end_particles(left);
  if (++state.since_sort >= sort_every) {
    p.sort_by_cell();
    state.since_sort = 0;
  }
  g.rebuild(p);
}

void Solver::Impl::restrain_momentum() {
  reactions.clear();
  restraints.apply(state.time, g, reactions);
  bodies.apply(state.time, g, reactions);
}

void Solver::Impl::restrain_velocity() {
  restraints.apply_to_remapped(state.time, g);
  bodies.apply_to_remapped(state.time, g);
}

void Solver::Impl::book_work(double dt) {
  state.book.add(nodal_work(g, reactions, scheme.damping, dt), gather.transfer_loss);
}

void Solver::Impl::end_particles(const std::vector<std::uint32_t>& left) {
  for (const std::uint32_t k : left) {
    state.end[p.index[k]] = state.time;
    state.end_reason[p.index[k]] = EndReason::left_grid;
    const StoredEnergy lost = stored_energy_of(p, materials, k);
    state.book.carried += lost.kinetic + lost.elastic;
    for (auto* increment : {&p.de_xx, &p.de_yy, &p.de_zz, &p.de_xy, &p.spin}) (*increment)[k] = 0;
  }
}

double Solver::Impl::longest_step() const {
  return mpm::stable_step(options.courant, g.grid.spacing.minCoeff(), wave_speed,
                     std::max(state.fastest, bodies.fastest()));
}

double Solver::Impl::work_of_gravity() const {
  double work = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    work += p.mass[k] * gravity.dot(Vec2(p.x[k], p.y[k]) - scene.particles.x0[p.index[k]]);
  return work;
}

EnergyRow Solver::Impl::energy() const {
  EnergyBook book = state.book;
  book.gravity = work_of_gravity();
  return energy_row(state.time, stored_energy(p, materials), book);
}

void Solver::Impl::check_balance() {
  const EnergyRow row = energy();
  if (!std::isfinite(row.residual)) fail("the energy is not finite");
  const double limit = largest_gain * turnover(row, state.book);
  if (row.residual > limit) {
    std::ostringstream text;
    text << "the scheme gained " << row.residual << " J/m, more than a quarter of what was turned over ("
         << limit / largest_gain << " J/m)";
    fail(text.str());
  }
  good = state;
}

void Solver::Impl::fail(const std::string& cause) {
  std::ostringstream text;
  text << "mpm: at t = " << state.time << " s, step " << state.steps << ": " << cause << "; the state at t = "
       << good.time << " s is the last good one";
  state = good;
  g.rebuild(p);
  throw RunError(text.str());
}

void Solver::Impl::restart_books() {
  state.book = EnergyBook{};
  const StoredEnergy stored = stored_energy(p, materials);
  state.book.start = stored.kinetic + stored.elastic;
  good = state;
}

Solver::Solver(const MpmOptions& options, Scene scene, int threads)
    : impl_(std::make_unique<Impl>(options, std::move(scene), threads)) {}
Solver::~Solver() = default;

void Solver::settle(Progress& progress) {
  Impl& s = *impl_;
  if (s.state.steps > 0) throw RunError("mpm: settle() was called after the first step");
  settle_particles({s.gravity, s.options.settle_damping, s.options.settle_tolerance, s.most_threads}, s.materials,
                   s.restraints, s.bodies, s.p, s.g, progress);
  for (auto* history : {&s.p.plastic_dev, &s.p.gap, &s.p.dissipated}) std::fill(history->begin(), history->end(), 0.0);
  std::fill(s.p.opened.begin(), s.p.opened.end(), std::uint8_t{0});
  s.restart_books();
}

void Solver::advance_to(double time, Progress& progress) {
  Impl& s = *impl_;
  while (s.state.time < time) {
    const double stop = std::min({time, s.restraints.next_change(s.state.time), s.bodies.next_change(s.state.time)});
    const double longest = s.longest_step(), dt = trimmed_step(s.state.time, stop, longest);
    s.step(dt);
    s.state.time = stop - s.state.time <= longest ? stop : s.state.time + dt;
    if (s.observer) s.observer(dt, [&s](const Vec2& x) { return s.g.velocity_at(x); });
    if (s.state.steps % check_every == 0) {
      s.check_balance();
      progress.update("mpm", s.state.steps, s.state.steps + std::int64_t(std::ceil((time - s.state.time) / dt)));
      if (progress.stop_requested()) throw Interrupted();
    }
  }
  s.check_balance();
}

double Solver::time() const { return impl_->state.time; }
std::int64_t Solver::steps() const { return impl_->state.steps; }
double Solver::stable_step() const { return impl_->longest_step(); }
Vec2 Solver::momentum() const {
  const Particles& p = impl_->p;
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass[k] * Vec2(p.vx[k], p.vy[k]);
  return sum;
}
EnergyRow Solver::energy() const { return impl_->energy(); }

const ParticleSet& Solver::particles() const {
  impl_->scene.particles.end = impl_->state.end;
  impl_->scene.particles.end_reason = impl_->state.end_reason;
  return impl_->scene.particles;
}

MotionFrame Solver::frame() const { return frame_of(impl_->state, impl_->scene.particles); }

void Solver::on_step(std::function<void(double dt, const VelocityAt&)> observer) {
  impl_->observer = std::move(observer);
}

std::vector<std::byte> Solver::save() const { return to_bytes(impl_->state); }

void Solver::load(const std::vector<std::byte>& checkpoint) {
  from_bytes(checkpoint, impl_->state);
  impl_->g.rebuild(impl_->p);
  impl_->good = impl_->state;
}

}  // namespace pivnp::mpm

// What a run watches: the energy balance, whether motion has ended, points that end, and failure.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "mpm/solver/impl.hpp"
#include "mpm/step/swing.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr double heavy_mass = 0.05;           // of a full cell: nodes whose speed says something
constexpr double calm = 1e-3;                 // of the peak kinetic energy
constexpr double calm_share = 0.1;            // of the run for which it has to be calm, and
constexpr std::int64_t first_judged = 10;     // step at which the balance is first held against the limit
constexpr int calm_looks = 10;                // looks at the balance
constexpr double pressure_round_off = 1e-12;  // of the water's modulus
constexpr double still = 0.01;                // cells that the fastest node may still go in the time run so far

}  // namespace

void Solver::Impl::add_work(const Cycle& c) {
  const bool strained = scheme.stress != StressUpdate::usf;
  const NodalWork done = nodal_work(g, reactions, state.touched, scheme.damping, c.push, strained, c.threads);
  state.balance.add(done, gather.kinetic_loss);
  last = {leaps() ? c.push : 0, leaps() ? c.dt : 0, done.contact, done.damping, done.bodies};
  for (const Reaction& r : reactions)
    if (r.body >= 0) impulses_of_bodies()[std::size_t(r.body)].add({r.impulse_x, r.impulse_y}, g.place(r.node));
  if (pushes()) {
    std::vector<Vec2> more(state.touched.size());
    std::transform(state.touched.begin(), state.touched.end(), more.begin(),
                   [&](const TouchedNode& t) { return working_velocity_by_touch(g, t, strained); });
    std::size_t t = 0;
    for (const std::uint32_t n : g.active.nodes) {
      Vec2 w = working_velocity(g, n, strained);
      while (t < more.size() && state.touched[t].node < n) ++t;
      if (t < more.size() && state.touched[t].node == n) w += more[t];
      const double work = c.push * (g.arrays.loads[n].x * w.x() + g.arrays.loads[n].y * w.y());
      state.balance.bodies += work;
      last.bodies += work;
      state.balance.loads += work;
    }
  }
  state.touched.clear();
  for (const std::uint32_t n : bodies.touched_nodes()) {
    const Vec2 u = strained ? std::as_const(g).strain_velocity(n) : Vec2(g.node[n].nx, g.node[n].ny);
    state.touched.push_back({n, u.x(), u.y()});
  }
}

void Solver::Impl::end_particle(std::size_t k, EndReason reason) {
  state.ended.push_back({state.time, p.index[k], reason});
  scene.particles.end[p.index[k]] = state.time;
  scene.particles.end_reason[p.index[k]] = reason;
  const StoredEnergy lost = stored_energy_of(p, g, materials, k);
  state.balance.carried += lost.kinetic + lost.elastic;
  if (water) end_water(k);
  if (heat) end_heat(k);
  p.cell[k] = Particles::ended;
}

void Solver::Impl::watch_motion() {
  for (const auto& [name, b] : scene.boundaries)  // (beside tied sides material passes a lid that moves along itself)
    if (water && !restraints.tied().any() && b.velocity_m_s && !b.grips &&
        Vec2((*b.velocity_m_s)[0], (*b.velocity_m_s)[1]).norm() * std::min(state.time, b.until_s.value_or(state.time)) > g.grid.spacing.maxCoeff())
      fail("boundary." + name + " has moved by more than a cell, and its nodes hold no material any more; expected a [body.NAME] beside water");
  const NodalMotion motion = nodal_motion(g, heavy_mass * least_density() * g.grid.spacing.prod());
  state.peak_kinetic = std::max(state.peak_kinetic, motion.kinetic);
  const bool stands = motion.kinetic < calm * state.peak_kinetic &&
                      std::sqrt(motion.fastest2) * state.time < still * g.grid.spacing.minCoeff();
  const bool is_calm = (!water || pressure_lasts()) && stands;
  if (!is_calm) {
    state.calm_since = state.time;
    state.calm_looks = 0;
    state.calm_excess = {excess_now.excess, excess_now.excess2};
  }
  state.far = moved_far();
  state.at_rest = is_calm && !heat && ++state.calm_looks > calm_looks && !scene.body_force &&
                  state.time - state.calm_since > calm_share * state.time &&
                  std::isinf(restraints.next_change(state.time)) && !loading.changing_after(state.time) &&
                  !(water && water->moves_after(state.time)) && !bodies.moving_after(state.time);
}

// Consolidation goes on long after anything is seen to move.
bool Solver::Impl::pressure_lasts() {
  const double round_off = pressure_round_off * scene.water->bulk_modulus_pa;
  const auto lasts = [](double now, double before, double& peak, double least) {
    peak = std::max(peak, std::abs(now));
    return std::abs(now - before) <= calm * peak + least;
  };
  const bool mean = lasts(excess_now.excess, state.calm_excess.excess, state.peak_excess.excess, round_off * excess_now.volume);
  return lasts(excess_now.excess2, state.calm_excess.excess2, state.peak_excess.excess2, round_off * round_off * excess_now.volume) && mean;
}

bool Solver::Impl::moved_far() const {
  if (!options.end_displacement_m) return false;
  const double most2 = *options.end_displacement_m * *options.end_displacement_m;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies.mass(b, state.time) > 0 && bodies.displacement(b, state.time).squaredNorm() >= most2) return true;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended &&
        p.displacement(k, scene.particles.x0[p.index[k]]).squaredNorm() >= most2)
      return true;
  return false;
}

double Solver::Impl::work_of_gravity() const {
  double work = 0;
  const Vec2 gravity = loading.gravity(state.time);
  for (std::size_t k = 0; k < p.size(); ++k)
    work += p.mass_of(k) * gravity.dot(p.displacement(k, scene.particles.x0[p.index[k]]));
  return work;
}

EnergyRow Solver::Impl::energy() {
  EnergyBalance balance = state.balance;
  if (!work_in_steps() && !water) balance.gravity = work_of_gravity();
  if (water && !water_works_in_steps()) balance.gravity = balance.potential - potential_of_water();
  StoredEnergy stored = stored_energy(p, g, materials);
  const PoreWater::Sums in_pores = water ? water->sums(p, loading.gravity(state.time)) : PoreWater::Sums{};
  stored.water = in_pores.energy;
  excess_now = in_pores;
  EnergyRow row = energy_row(state.time, stored, balance);
  row.water_mass = in_pores.mass;
  if (heat) row.heat = heat->contained(p);
  if (scheme.shape == ShapeKind::bilinear) row.hourglass = hourglass_energy(p, g);
  return row;
}

// The same with the velocities of the state's time.
EnergyRow Solver::Impl::energy_now() {
  EnergyRow row = energy();
  const double kinetic = last.share() > 0 ? pushed_kinetic(p, g, last) - row.kinetic : 0;
  row.kinetic += kinetic;
  row.damping += last.share() * last.damping;
  row.contact += last.share() * last.contact;
  row.external += last.share() * last.bodies;
  row.residual += kinetic + last.share() * (last.damping + last.contact - last.bodies);
  return row;
}

// Does a wall let go, a load end, or is material taken out, at once, at a time? (A wall that is drawn away lets go of node after node.)
bool Solver::Impl::forces_jump(double time) const {
  return std::any_of(scene.boundaries.begin(), scene.boundaries.end(),
                     [time](const auto& b) { return b.second.until_s == time && !b.second.withdraw_m_s; }) ||
         std::any_of(scene.materials.begin(), scene.materials.end(), [time](const MaterialOptions& m) { return m.removed_s == time; });
}

// The state itself is brought to its time: before forces jump, so that the next push is that of half a step with the new ones, and
// where nothing is stepped any more.
void Solver::Impl::catch_up() {
  for (std::size_t k = 0; k < p.size() && last.share() > 0; ++k) {
    const VelocityChange more = pushed_on(p, g, k, last);
    p.vx[k] += more.v.x();
    p.vy[k] += more.v.y();
    if (p.C_xx.empty()) continue;
    p.C_xx[k] += more.affine(0, 0);
    p.C_xy[k] += more.affine(0, 1);
    p.C_yx[k] += more.affine(1, 0);
    p.C_yy[k] += more.affine(1, 1);
  }
  state.balance.damping += last.share() * last.damping;
  state.balance.contact += last.share() * last.contact;
  state.balance.bodies += last.share() * last.bodies;
  for (std::size_t k = 0; k < impulses_before.size(); ++k) state.impulses[k] = impulse_now(k);
  state.last_step = 0;
  last = {};
}

void Solver::Impl::bring_to_time(MotionFrame& frame) const {
  for (std::size_t k = 0; k < p.size() && last.share() > 0; ++k) {
    const Vec2 now = Vec2(p.vx[k], p.vy[k]) + pushed_on(p, g, k, last).v;
    frame.v[p.index[k]] = {float(now.x()), float(now.y())};
  }
}

Impulse Solver::Impl::impulse_now(std::size_t k) const {
  const Impulse &now = state.impulses[k], &before = last.share() > 0 ? impulses_before[k] : now;
  return {now.x + last.share() * (now.x - before.x), now.y + last.share() * (now.y - before.y),
          now.moment + last.share() * (now.moment - before.moment)};
}

void Solver::Impl::check_balance() {
  const EnergyRow row = energy();
  if (!std::isfinite(row.residual)) fail("the energy is not finite");
  double& turned_over = state.balance.turned_over;
  turned_over = std::max(turned_over, turnover(row, state.balance));
  const double gain = gained(row, state.balance);
  // (The balance here takes velocities as they are stored, of half a step ago: after n steps of a fall it is off by 1/n of the work.)
  const double most = options.energy_limit * std::max(turned_over, least_turned_over);
  const auto swings = [&] {
    if (!leaps() || bodies.size() > 0 || !contacts.empty() || sleep.any()) return false;
    const Swing swing = leapfrog_swing(p, g, scheme, loading.gravity(state.time), last, most_threads);
    return swing.share2 < 1 && std::abs(row.residual - swing.energy) <= most;
  };
  if (state.steps >= first_judged && std::abs(row.residual) > most && !swings()) {
    std::ostringstream text;
    text << "the energy residual is " << row.residual << " J/m, beyond " << options.energy_limit
         << " of the energy supplied (" << std::max(turned_over, least_turned_over) << " J/m; mpm.energy_limit)";
    fail(text.str());
  }
  if (state.steps >= first_judged && gain > most) {
    std::ostringstream text;
    text << "energy was gained where it can only be lost (plastic, damping, contact, darcy): " << gain << " J/m, beyond "
         << options.energy_limit << " of the energy supplied (" << std::max(turned_over, least_turned_over)
         << " J/m; mpm.energy_limit)";
    fail(text.str());
  }
  good = {row, state.steps};
}

void Solver::Impl::fail(const std::string& cause) {
  std::ostringstream text;
  text << "mpm: at t = " << state.time << " s, step " << state.steps << ": " << cause << "; the balance was last sound at t = "
       << good.energy.time << " s";
  failed = true;
  throw RunError(text.str());
}

void Solver::Impl::restart_balance() {
  state.balance = EnergyBalance{};
  const StoredEnergy stored = stored_energy(p, g, materials);
  state.balance.start = stored.kinetic + stored.elastic + (water ? water->sums(p, loading.gravity(state.time)).energy : 0);
  if (water) state.balance.potential = potential_of_water();
  failed = false;
  good = {energy(), state.steps};
}

// The particles' ends as the state has them, instead of those of `before`.
void Solver::Impl::restore_ends(const std::vector<SolverState::Ended>& before) {
  for (const auto& e : before) {
    scene.particles.end[e.particle] = std::numeric_limits<double>::quiet_NaN();
    scene.particles.end_reason[e.particle] = EndReason::none;
  }
  for (const auto& e : state.ended) {
    if (e.particle >= scene.particles.size()) throw InputError("checkpoint: it ends a particle that the scene lacks");
    scene.particles.end[e.particle] = e.time;
    scene.particles.end_reason[e.particle] = e.reason;
  }
}

}  // namespace pivnp::mpm

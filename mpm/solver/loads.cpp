// What a run changes by the case's will: body forces, tractions, densities, strengths, excavation, the start at rest.
#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/material/model.hpp"
#include "mpm/solver/impl.hpp"
#include "mpm/step/initial_equilibrium.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t bad_states_every = 8;  // steps between looks for them
// Greatest |F|^2 over the lesser of J and 1. A record keeps F in single precision: beyond some 2^22 the determinant of
// what it keeps has no sign any more. It stays below that from one look to the next.
constexpr double most_stretch2 = 1 << 20;
constexpr double least_volume = 0.1;  // of the initial: the grains of no soil leave room for less

// False for NaN too.
bool sound(double xx, double xy, double yx, double yy, double J) {
  const double squares = xx * xx + xy * xy + yx * yx + yy * yy;
  return J >= least_volume && xx * yy - xy * yx > 0 && squares <= most_stretch2 * std::min(J, 1.0);
}

}  // namespace

// What changes by the case's will, before a step: strengths as at its end, to which the stress is updated; material
// taken out by its start. (Densities are those of its start, as the forces are: end_step() has changed them.)
void Solver::Impl::load(double dt) {
  change_strength(state.time + dt);
  remove_due();
  if (state.steps % bad_states_every == 0) end_bad_states();
}

void Solver::Impl::map_loads(double dt, int threads) {
  if (!pushes()) return;
  for_nodes(g, threads, [&](Node&, std::uint32_t n) { g.arrays.loads[n] = {}; });
  if (scene.body_force) {
    std::vector<double> ax(p.size(), 0.0), ay(p.size(), 0.0);
    for (std::size_t k = 0; k < p.size(); ++k) {
      if (p.cell[k] == Particles::ended) continue;
      const Vec2 a = scene.body_force(p.index[k], state.time);
      ax[k] = a.x();
      ay[k] = a.y();
    }
    map_acceleration(p, g, ax, ay, threads);
  }
  if (const Centrifuge* field = loading.centrifuge())
    for_nodes(g, threads, [&](Node& node, std::uint32_t n) {
      const Vec2 a = field->acceleration(g.place(n), state.time);
      g.arrays.loads[n].x += node.mass * a.x();
      g.arrays.loads[n].y += node.mass * a.y();
    });
  if (loading.tractions().any()) loading.tractions().add_to_loads(p, g, state.time, dt, impulses_of_tractions(), threads);
  for_nodes(g, threads, [&](Node& node, std::uint32_t n) {
    node.fx += g.arrays.loads[n].x;
    node.fy += g.arrays.loads[n].y;
  });
}

void Solver::Impl::turn_by_coriolis(const Cycle& c) {
  const Centrifuge* field = loading.centrifuge();
  if (!field || !field->coriolis()) return;
  const double angle = field->rate(state.time + 0.5 * (c.dt - c.push)) * c.push;
  for_nodes(g, c.threads, [&](Node& node, std::uint32_t) {
    const Vec2 n = Centrifuge::turned({node.vx, node.vy}, {node.nx, node.ny}, angle);
    node.nx = n.x();
    node.ny = n.y();
  });
}

std::function<Vec2(const Vec2&)> Solver::Impl::variation_of_gravity() const {
  if (!loading.centrifuge()) return {};
  return [field = loading.centrifuge(), mean = loading.centrifuge()->acceleration(centroid(scene.particles), 0)](const Vec2& x) {
    return Vec2(field->acceleration(x, 0) - mean);
  };
}

RigidBodies::Field Solver::Impl::field_of_bodies() const {
  if (!loading.centrifuge()) return {};
  return [field = loading.centrifuge(), time = state.time](const Vec2& x, const Vec2& v) {
    return Vec2(field->acceleration(x, time) + field->coriolis(v, time));
  };
}

// Mass that comes moves as the point does: its kinetic energy is work done from outside.
void Solver::Impl::change_densities(double time, bool balance) {
  if (!loading.any_density()) return;
  for (const Particles::Body& body : p.bodies) {
    const auto material = std::size_t(body.material);
    const double now = scene.materials[material].density_kg_m3 * loading.density_ratio(material, time);
    density[material] = now;
    if (!balance) continue;
    const double before = p.density;
    if (p.mass.empty()) p.density = now;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      const double mass = now * p.volume0[k], mass_before = p.mass.empty() ? before * p.volume0[k] : p.mass[k];
      if (mass == mass_before || p.cell[k] == Particles::ended) continue;
      if (!p.mass.empty()) p.mass[k] = mass;
      state.balance.bodies += (1 - mass_before / mass) * stored_kinetic(p, g, k);
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
    now[k] = reduced(now[k], factor);
  }
  if (changed) materials = materials_of(scene, now);
}

void Solver::Impl::remove_due() {
  bool any = false;
  for (const Particles::Body& body : p.bodies) {
    if (loading.removal(std::size_t(body.material)) > state.time) continue;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      if (p.cell[k] == Particles::ended) continue;
      end_particle(k, EndReason::removed);
      any = true;
    }
  }
  if (any) g.rebuild(p);
}

// Points torn off alone are sheared, stretched and crushed without bound by their own nodes. (What is no number has gone through
// the nodes within a step, and ends the run.)
void Solver::Impl::end_bad_states() {
  bool any = false;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended || sound(p.F_xx[k], p.F_xy[k], p.F_yx[k], p.F_yy[k], p.J[k])) continue;
    end_particle(k, EndReason::bad_state);
    any = true;
  }
  if (any) g.rebuild(p);
}

void Solver::Impl::start_at_rest(const Vec2& gravity) {
  if (std::abs(gravity.x()) > 1e-3 * std::abs(gravity.y()))
    throw InputError("mpm.k0: given where gravity is not vertical, expected initial_equilibrium = true without it");
  stress_from_columns(p, materials, g, gravity.y(), options.k0, water.get());
  if (water) water->refresh(p, gravity, 1);
}

Vec2 Solver::Impl::moment_of_mass() const {
  Vec2 sum(0, 0);
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += p.mass_of(k) * p.displacement(k, Vec2::Zero());
  return sum;
}

}  // namespace pivnp::mpm

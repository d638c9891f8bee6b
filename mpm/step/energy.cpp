#include "mpm/step/energy.hpp"

#include <algorithm>

#include "mpm/state/particle_fields.hpp"

namespace pivnp::mpm {

namespace {

// Kinetic energy per mass of a point's affine field, 1/2 C D C^T with the spline's second moment D = h^2/4 I for every
// shape: one number for the balance whatever the point's place in its cell.
double affine_energy(const Particles& p, const Vec2& h, std::size_t k) {
  if (p.C_xx.empty()) return 0;
  return 0.125 * ((p.C_xx[k] * p.C_xx[k] + p.C_yx[k] * p.C_yx[k]) * h.x() * h.x() +
                  (p.C_xy[k] * p.C_xy[k] + p.C_yy[k] * p.C_yy[k]) * h.y() * h.y());
}

// `all`: the points as the law sees them; `work`: what they have dissipated, null where no law dissipates.
StoredEnergy of_point(const Particles& p, const GridState& g, const Material& material, const StressBatch& all,
                      const Array* work, std::size_t k) {
  return {p.mass_of(k) * (0.5 * (p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k]) + affine_energy(p, g.grid.spacing, k)),
          p.volume0[k] * material.energy(all, k), work ? p.volume0[k] * (*work)[k] : 0};
}

}  // namespace

StoredEnergy stored_energy(Particles& p, const GridState& g, const Materials& materials) {
  StoredEnergy sum;
  const Array* work = p.history.find(plastic_work.name);
  for (const Particles::Body& body : p.bodies) {
    const StressBatch all = batch_of(p, body, 0, p.size());
    const Material& material = *materials[std::size_t(body.material)];
    for (std::size_t k = body.begin; k < body.end; ++k) {
      const StoredEnergy point = of_point(p, g, material, all, work, k);
      sum.plastic += point.plastic;
      if (p.cell[k] == Particles::ended) continue;
      sum.kinetic += point.kinetic;
      sum.elastic += point.elastic;
    }
  }
  return sum;
}

double stored_kinetic(const Particles& p, const GridState& g, std::size_t k) {
  return p.mass_of(k) * (0.5 * (p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k]) + affine_energy(p, g.grid.spacing, k));
}

StoredEnergy stored_energy_of(Particles& p, const GridState& g, const Materials& materials, std::size_t k) {
  for (const Particles::Body& body : p.bodies)
    if (k >= body.begin && k < body.end)
      return of_point(p, g, *materials[std::size_t(body.material)], batch_of(p, body, 0, p.size()),
                      p.history.find(plastic_work.name), k);
  return {};
}

EnergyRow energy_row(double time, const StoredEnergy& stored, const EnergyBalance& balance) {
  EnergyRow row;
  row.time = time;
  row.kinetic = stored.kinetic;
  row.elastic = stored.elastic;
  row.plastic = stored.plastic;
  row.damping = balance.damping;
  row.contact = balance.contact;
  row.external = balance.gravity + balance.bodies - balance.carried;
  row.water = stored.water;
  row.darcy = balance.darcy;
  row.water_inflow = balance.inflow;
  row.heat_made = balance.heat_made;
  row.heat_inflow = balance.heat_inflow;
  row.residual = row.kinetic + row.elastic + row.plastic + row.damping + row.contact - row.external - balance.start +
                 (row.water + row.darcy);
  return row;
}

double turnover(const EnergyRow& row, const EnergyBalance& balance) {
  const double of_gravity = row.external - balance.bodies;
  return balance.start + std::abs(of_gravity) + std::abs(balance.loads) +
         std::max(std::abs(balance.bodies - balance.loads), balance.moved);
}

double gained(const EnergyRow& row, EnergyBalance& balance) {
  double sum = 0;
  const std::array now{row.plastic, row.damping, row.contact, row.darcy};
  for (std::size_t k = 0; k < now.size(); ++k) {
    balance.dissipated[k] = std::max(balance.dissipated[k], now[k]);
    sum += balance.dissipated[k] - now[k];
  }
  return sum;
}

double least_turnover(const Particles& p, const Materials& materials, double gravity, double cell_m) {
  constexpr double cells = 1e-6, strain = 1e-8;
  double sum = 0;
  for (const Particles::Body& body : p.bodies) {
    const double modulus = materials[std::size_t(body.material)]->elastic().p_wave_modulus();
    for (std::size_t k = body.begin; k < body.end; ++k)
      sum += p.mass_of(k) * gravity * cells * cell_m + 0.5 * modulus * strain * strain * p.volume0[k];
  }
  return sum;
}

}  // namespace pivnp::mpm

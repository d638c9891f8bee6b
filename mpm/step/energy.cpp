#include "mpm/step/energy.hpp"

#include "mpm/grid/kernel.hpp"
#include "mpm/state/particle_fields.hpp"

namespace pivnp::mpm {

namespace {

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

EnergyRow energy_row(double time, const StoredEnergy& stored, const EnergyBook& book) {
  EnergyRow row;
  row.time = time;
  row.kinetic = stored.kinetic;
  row.elastic = stored.elastic;
  row.plastic = stored.plastic;
  row.damping = book.damping;
  row.contact = book.contact;
  row.external = book.gravity + book.bodies - book.carried;
  row.residual = row.kinetic + row.elastic + row.plastic + row.damping + row.contact - row.external - book.start;
  return row;
}

double turnover(const EnergyRow& row, const EnergyBook& book) {
  return row.plastic + row.damping + row.contact + std::abs(row.external) + book.start + book.moved;
}

}  // namespace pivnp::mpm

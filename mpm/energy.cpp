#include "mpm/energy.hpp"

namespace pivnp::mpm {

namespace {

StoredEnergy of_point(const Particles& p, const Elastic& elastic, std::size_t k) {
  return {0.5 * p.mass[k] * (p.vx[k] * p.vx[k] + p.vy[k] * p.vy[k]),
          p.volume0[k] * elastic.energy(p.tau_xx[k], p.tau_yy[k], p.tau_zz[k], p.tau_xy[k]),
          p.volume0[k] * p.dissipated[k]};
}

}  // namespace

StoredEnergy stored_energy(const Particles& p, const Materials& materials) {
  StoredEnergy sum;
  for (const Particles::Body& body : p.bodies) {
    const Elastic& elastic = materials[std::size_t(body.material)]->elastic();
    for (std::size_t k = body.begin; k < body.end; ++k) {
      const StoredEnergy point = of_point(p, elastic, k);
      sum.plastic += point.plastic;
      if (p.cell[k] == Particles::ended) continue;
      sum.kinetic += point.kinetic;
      sum.elastic += point.elastic;
    }
  }
  return sum;
}

StoredEnergy stored_energy_of(const Particles& p, const Materials& materials, std::size_t k) {
  for (const Particles::Body& body : p.bodies)
    if (k >= body.begin && k < body.end) return of_point(p, materials[std::size_t(body.material)]->elastic(), k);
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

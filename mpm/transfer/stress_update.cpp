#include "mpm/transfer/stress_update.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/state/history.hpp"
#include "mpm/state/particle_fields.hpp"
#include "mpm/transfer/transfer.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::size_t run = 1024;

// Do they follow one another? (No early end: so the loop goes in lanes.)
bool together(const std::uint32_t* places, std::size_t n) {
  std::uint32_t other = 0;
  for (std::size_t k = 0; k < n; ++k) other |= places[k] ^ (places[0] + std::uint32_t(k));
  return other == 0;
}

// Of a point before its update.
struct Before {
  Stress stress;
  double work, strain, opening;  // what its law remembers
};

// The work of the step's mean stress on its strain.
double work_of_mean(const StressBatch& b, std::size_t q, std::size_t k, const Stress& before) {
  const Stress from = turned_by(b.spin[q], before);
  return 0.5 *
             ((from.xx + b.xx[k]) * b.de_xx[q] + (from.yy + b.yy[k]) * b.de_yy[q] + (from.zz + b.zz[k]) * b.de_zz[q]) +
         (from.xy + b.xy[k]) * b.de_xy[q];
}

// Strength sees the stress shifted (StressBatch::shift), but never so far that the trial would leave its cone by the apex: a band
// that pressure opens is none of these equations.
void update_shifted(const Material& material, const StressBatch& batch) {
  constexpr double most = 0.9999;  // of the trial's mean stress: more would be left of the strength than of a sealed band's
  const Elastic& elastic = material.elastic();
  const double bulk = elastic.lambda + 2 * elastic.shear / 3;
  static thread_local std::vector<double> by;
  by.assign(batch.size, 0.0);
  bool any = false;
  for (std::size_t q = 0; q < batch.size; ++q) {
    const std::size_t k = batch.places ? batch.places[q] : q;
    if (batch.shift[k] == 0) continue;
    const double trial =
        (batch.xx[k] + batch.yy[k] + batch.zz[k]) / 3 + bulk * (batch.de_xx[q] + batch.de_yy[q] + batch.de_zz[q]);
    by[q] = std::min(batch.shift[k], most * std::max(0.0, -trial));
    any = true;
  }
  if (!any) return material.update(batch);
  const auto add = [&](double sign) {
    for (std::size_t q = 0; q < batch.size; ++q) {
      const std::size_t k = batch.places ? batch.places[q] : q;
      if (by[q] == 0) continue;
      for (double* stress : {batch.xx, batch.yy, batch.zz}) stress[k] += sign * by[q];
    }
  };
  add(1);
  material.update(batch);
  add(-1);
}

// Beside bands: a shift that comes and goes lets strength jump from step to step, and much is done by a stress that the
// law no longer sees at the end of its step. The plastic work is therefore that of the mean stress of each step, which
// with the elastic energy is all that was done (docs/theory/mpm_heat.md#embedded-bands).
void update_beside_bands(const Material& material, const StressBatch& batch) {
  if (material.history().empty() || material.history()[plastic::strain].name != plastic_strain.name)
    return update_shifted(material, batch);
  double* work = batch.history[plastic::work];
  const double* strain = batch.history[plastic::strain];
  const double* opening =
      batch.history[plastic::opening] ? batch.history[plastic::opening] : strain;  // (some never open)
  static thread_local std::vector<Before> before;
  before.resize(batch.size);
  for (std::size_t q = 0; q < batch.size; ++q) {
    const std::size_t k = batch.places ? batch.places[q] : q;
    before[q] = {{batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]}, work[k], strain[k], opening[k]};
  }
  update_shifted(material, batch);
  const Elastic& elastic = material.elastic();
  for (std::size_t q = 0; q < batch.size; ++q) {
    const std::size_t k = batch.places ? batch.places[q] : q;
    const auto& [from, work_before, strain_before, opening_before] = before[q];
    // (At the cone's tip, and where a point stands open, the law's own work is nothing.)
    if (batch.shift[k] == 0 && work[k] == work_before && strain[k] == strain_before && opening[k] == opening_before)
      continue;
    const double stored = elastic.energy(batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]) -
                          elastic.energy(from.xx, from.yy, from.zz, from.xy);
    work[k] = work_before + work_of_mean(batch, q, k, from) - stored;
  }
}

// `softened_by` is there if any law averages: the others take their own strain.
void update_batch(const Material& material, StressBatch& batch) {
  if (!(material.nonlocal_length() > 0)) batch.softened_by = nullptr;
  batch.shift&& batch.dt > 0 ? update_beside_bands(material, batch)
                             : material.update(batch);  // (no band has formed at the start)
}

}  // namespace

void update_stress(const Materials& materials, Particles& p, int threads, double dt_s) {
  if (p.de_xx.size() != p.size()) p.resize_increments(p.size());
  for (const Particles::Body& body : p.bodies) {
    const Material& material = *materials[std::size_t(body.material)];
    const auto runs = std::ptrdiff_t((body.end - body.begin + run - 1) / run);
#pragma omp parallel for num_threads(threads) schedule(static) if (threads > 1 && runs > 1)
    for (std::ptrdiff_t r = 0; r < runs; ++r) {
      const std::size_t begin = body.begin + std::size_t(r) * run;
      StressBatch batch = batch_of(p, body, begin, std::min(run, body.end - begin));
      batch.dt = dt_s;
      update_batch(material, batch);
    }
  }
}

double strain_and_update_stress(const Materials& materials, Particles& p, GridState& g, const Scheme& scheme, double dt,
                                int threads, GatherSums* moved) {
  return strain_and_update(
      p, g, scheme, dt, true,
      [&](const Particles::Body& body, const std::uint32_t* places, const StressBatch& de) {
        const Material& material = *materials[std::size_t(body.material)];
        const auto update = [&](StressBatch batch, const StressBatch& steps) {
          batch.de_xx = steps.de_xx;
          batch.de_yy = steps.de_yy;
          batch.de_zz = steps.de_zz;
          batch.de_xy = steps.de_xy;
          batch.spin = steps.spin;
          batch.dt = dt;
          update_batch(material, batch);
        };
        if (together(places, de.size)) return update(batch_of(p, body, places[0], de.size), de);
        if (material.takes_places()) {
          StressBatch all = batch_of(p, body, 0, de.size);
          all.places = places;
          return update(all, de);
        }
        for (std::size_t begin = 0, end = 0; begin < de.size; begin = end) {
          while (end < de.size && places[end] == places[begin] + (end - begin)) ++end;
          update(batch_of(p, body, places[begin], end - begin), de.part(begin, end - begin));
        }
      },
      threads, moved);
}

double wave_speed(const Materials& materials, const std::vector<double>& density, Particles& p, int threads,
                  const std::vector<double>& added) {
  double fastest2 = 0;
  for (const Particles::Body& body : p.bodies) {
    const Material& material = *materials[std::size_t(body.material)];
    const auto runs = std::ptrdiff_t((body.end - body.begin + run - 1) / run);
    double stiffness = 0;
#pragma omp parallel for num_threads(threads) schedule(static) reduction(max : stiffness) if (threads > 1 && runs > 1)
    for (std::ptrdiff_t r = 0; r < runs; ++r) {
      const std::size_t begin = body.begin + std::size_t(r) * run;
      stiffness = std::max(stiffness, material.stiffness(batch_of(p, body, begin, std::min(run, body.end - begin))));
    }
    if (!added.empty()) stiffness += added[std::size_t(body.material)];
    fastest2 = std::max(fastest2, stiffness / density[std::size_t(body.material)]);
  }
  return std::sqrt(fastest2);
}

}  // namespace pivnp::mpm

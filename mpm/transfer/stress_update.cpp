#include "mpm/transfer/stress_update.hpp"

#include <algorithm>
#include <cmath>

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
  double elastic, work, strain, opening;  // its energy, J/m^3; what the law remembers of it
};

// The work of the step's mean stress on its strain.
double work_of_mean(const StressBatch& b, std::size_t q, std::size_t k, const Stress& before) {
  const Stress from = turned_by(b.spin[q], before);
  return 0.5 * ((from.xx + b.xx[k]) * b.de_xx[q] + (from.yy + b.yy[k]) * b.de_yy[q] + (from.zz + b.zz[k]) * b.de_zz[q]) +
         (from.xy + b.xy[k]) * b.de_xy[q];
}

// Strength sees the stress shifted (StressBatch::shift), but never so far that the trial would leave its cone by the apex: a band
// that pressure opens is none of these equations.
//
// A shift that comes and goes lets strength jump from step to step. The plastic work of the steps is therefore that of the mean stress of
// each, which with the elastic energy is all the work that was done, and no longer that of the stress at its end (docs/theory/mpm_heat.md).
void update_shifted(const Material& material, const StressBatch& batch) {
  constexpr double most = 0.9999;  // of the trial's mean stress: more would be left of the strength than of a sealed band's
  const Elastic& elastic = material.elastic();
  const double bulk = elastic.lambda + 2 * elastic.shear / 3;
  static thread_local std::vector<double> by;
  static thread_local std::vector<Before> before;
  by.resize(batch.size);
  before.resize(batch.size);
  double* work = batch.history[plastic::work];
  const double* strain = batch.history[plastic::strain];
  const double* opening = batch.history[plastic::opening] ? batch.history[plastic::opening] : strain;  // (some never open)
  const auto add = [&](double sign) {
    for (std::size_t q = 0; q < batch.size; ++q) {
      const std::size_t k = batch.places ? batch.places[q] : q;
      if (by[q] == 0) continue;
      for (double* stress : {batch.xx, batch.yy, batch.zz}) stress[k] += sign * by[q];
    }
  };
  for (std::size_t q = 0; q < batch.size; ++q) {
    const std::size_t k = batch.places ? batch.places[q] : q;
    const double trial = (batch.xx[k] + batch.yy[k] + batch.zz[k]) / 3 + bulk * (batch.de_xx[q] + batch.de_yy[q] + batch.de_zz[q]);
    by[q] = std::min(batch.shift[k], most * std::max(0.0, -trial));
    if (work) before[q] = {{batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]}, material.energy(batch, k), work[k], strain[k], opening[k]};
  }
  add(1);
  material.update(batch);
  add(-1);
  for (std::size_t q = 0; work && q < batch.size; ++q) {
    const std::size_t k = batch.places ? batch.places[q] : q;
    // (At the cone's tip, and where a point stands open, the law's own work is nothing.)
    if (batch.shift[k] != 0 || work[k] != before[q].work || strain[k] != before[q].strain || opening[k] != before[q].opening)
      work[k] = before[q].work + work_of_mean(batch, q, k, before[q].stress) - (material.energy(batch, k) - before[q].elastic);
  }
}

// `softened_by` is there if any law averages: the others take their own strain.
void update_batch(const Material& material, StressBatch& batch) {
  if (!(material.nonlocal_length() > 0)) batch.softened_by = nullptr;
  batch.shift && batch.dt > 0 ? update_shifted(material, batch) : material.update(batch);  // (no band has formed at the start)
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

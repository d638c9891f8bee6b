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

// `softened_by` is there if any law averages: the others take their own strain.
void update_batch(const Material& material, StressBatch& batch) {
  if (!(material.nonlocal_length() > 0)) batch.softened_by = nullptr;
  if (!batch.shift) return material.update(batch);
  const auto shift = [&](double sign) {
    for (std::size_t q = 0; q < batch.size; ++q) {
      const std::size_t k = batch.places ? batch.places[q] : q;
      if (batch.shift[k] == 0) continue;
      for (double* stress : {batch.xx, batch.yy, batch.zz}) stress[k] += sign * batch.shift[k];
    }
  };
  shift(1);
  material.update(batch);
  shift(-1);
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

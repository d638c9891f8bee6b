#include "mpm/heat/heat.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "mpm/state/particle_fields.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t pass_every = 8;   // steps between conductions
constexpr std::int64_t look_every = 4;   // passes between looks at the width of zones
constexpr double pass_share = 0.5;       // of the longest step of conduction
constexpr double cross_share = 0.25;     // of a cell that the flow may pass between two
constexpr double forgotten = 0.1;        // of the shear that a zone's width is found from, at each look
constexpr double most_waits = 7;         // passes that a band in which nothing slips is not advanced in
constexpr std::size_t points_in_part = 1024;      // points

}  // namespace

Heat::Heat(const HeatOptions& options, std::vector<HeatSoil> soils, const ParticleSet& particles, const Materials& materials, GridState& g,
           HeatBoundaries boundaries, const TiedSides& ties)
    : soils_(std::move(soils)),
      set_(&particles),
      initial_(options.initial_c),
      reference_(options.reference_c.value_or(options.initial_c)),
      carried_capacity_(0),
      conduction_(soils_, particles, g, std::move(boundaries), ties) {
  for (std::size_t m = 0; m < soils_.size(); ++m) {
    conducts_ = conducts_ || soils_[m].conductivity > 0;
    bands_ = bands_ || soils_[m].band > 0;
    carried_capacity_ = std::max(carried_capacity_, soils_[m].carried);
    const std::string name = m < particles.label_names.size() ? particles.label_names[m] : std::to_string(m);
    if (soils_[m].skeleton > 0 && materials[m]->from_deformation())
      throw InputError("material." + name + ".skeleton_thermal_expansion_1_k: found " + materials[m]->name() +
                       ", whose stress follows from its deformation alone; expected 0");
    if (soils_[m].band > 0 && std::none_of(materials[m]->history().begin(), materials[m]->history().end(),
                                           [](const HistoryVariable& v) { return v.name == plastic_work.name; }))
      throw InputError("material." + name + ".band_thickness_m: given with " + materials[m]->name() + ", expected a model that yields");
  }
  for (HeatSoil& soil : soils_)
    if (soil.band > 0) soil.take_cells(std::sqrt(g.grid.spacing.prod()));
  if (bands_) zone_.emplace(g, ties);
}

double Turning::look(double xx, double xy, double yx, double yy, double forgotten_share) {
  const double per = 1 / (F_xx * F_yy - F_xy * F_yx), d_xx = xx - F_xx, d_xy = xy - F_xy, d_yx = yx - F_yx, d_yy = yy - F_yy;
  // dF F^-1
  const double l_xx = per * (d_xx * F_yy - d_xy * F_yx), l_xy = per * (d_xy * F_xx - d_xx * F_xy);
  const double l_yx = per * (d_yx * F_yy - d_yy * F_yx), l_yy = per * (d_yy * F_xx - d_yx * F_xy);
  F_xx = xx, F_xy = xy, F_yx = yx, F_yy = yy;
  turned += 0.5 * (l_yx - l_xy) - forgotten_share * turned;
  sheared += std::hypot(0.5 * (l_xx - l_yy), 0.5 * (l_xy + l_yx)) - forgotten_share * sheared;
  return sheared > 0 ? std::clamp(turned / sheared, -1.0, 1.0) : 0;
}

void Heat::start(Particles& p, HeatState& state, const std::vector<double>& temperature) const {
  for (std::size_t k = 0; k < p.size(); ++k) p.temperature[k] = temperature.empty() ? initial_ : temperature[p.index[k]];
  std::fill(p.heated_by.begin(), p.heated_by.end(), 0.0);
  if (bands_) state.band_of.assign(p.size(), -1);
  if (bands_) state.turning.assign(p.size(), {});
}

double Heat::contained(const Particles& p) const {
  double sum = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.cell[k] != Particles::ended) sum += contained(p, k);
  return sum;
}

double Heat::pending(const Particles& p, std::size_t k) const {
  const Array* work = p.history.find(plastic_work.name);
  return work ? p.volume0[k] * ((*work)[k] - p.heated_by[k]) : 0;
}

HeatSums Heat::step(Particles& p, GridState& g, const Materials& materials, const PoreWater* water, HeatState& state,
                    double darcy, const Vec2& gravity, double time, double dt, bool last, int threads) {
  state.since += dt;
  ++state.steps;
  const bool due = last || state.steps % pass_every == 0 || state.since + dt > pass_share * longest_step(g) ||
                   (state.since + dt) * state.crossing > cross_share;
  if (!due) return {};
  const double since = state.since;
  state.since = 0;
  rise_.assign(p.size(), 0.0);
  HeatSums sums;
  if (conducts_ || (water && carried_capacity_ > 0)) {
    const Conduction::Sums moved =
        conduction_.conduct(p, g, water, carried_capacity_, darcy - state.darcy, gravity, time, since, rise_, threads);
    if (moved.darcy != 0) state.darcy = darcy;
    sums.inflow = moved.inflow;
    sums.made = moved.darcy;
    state.crossing = moved.crossing;
  }
  if (bands_) {
    if (state.passes % look_every == 0) look_at_zones(p, g, state, time);
    open_bands(p, state);
  }
  ++state.passes;
  sums.add(warm(p, materials, water,
                !bands_ ? WithBands::none
                : last  ? WithBands::all
                        : WithBands::that_slip,
                since, state, threads));
  if (water) water->follow_temperature(p, threads);
  if (bands_) shift_strength(p, state, threads);
  return sums;
}

HeatSums Heat::take_work(Particles& p, const Materials& materials, const PoreWater* water, HeatState& state, int threads) {
  rise_.assign(p.size(), 0.0);
  return warm(p, materials, water, WithBands::none, 0, state, threads);
}

// Points become warmer by `rise_` and by their work; what swells of that goes to water and skeleton.
HeatSums Heat::warm(Particles& p, const Materials& materials, const PoreWater* water, WithBands bands, double dt,
                    HeatState& state, int threads) {
  HeatSums sums;
  const Array* work = p.history.find(plastic_work.name);
  for (const Particles::Body& body : p.bodies) {
    const HeatSoil& soil = soils_[std::size_t(body.material)];
    const Material& material = *materials[std::size_t(body.material)];
    const StressBatch all = batch_of(p, body, 0, p.size());
    const Elastic& elastic = material.elastic();
    const double bulk = elastic.lambda + 2 * elastic.shear / 3, per_capacity = 1 / soil.capacity;
    const Array* opening = p.history.find(opening_strain.name);
    std::vector<HeatSums> parts((body.end - body.begin + points_in_part - 1) / points_in_part);
    for_each(parts.size(), threads, [&](std::size_t part) {
      HeatSums& sum = parts[part];
      for (std::size_t k = body.begin + part * points_in_part; k < std::min(body.end, body.begin + (part + 1) * points_in_part); ++k) {
        if (p.cell[k] == Particles::ended) continue;
        const double done = work ? (*work)[k] - p.heated_by[k] : 0;
        if (work) p.heated_by[k] = (*work)[k];
        double rise = rise_[k] + per_capacity * done;
        std::optional<double> swollen;  // where a band has something to say
        sum.made += p.volume0[k] * done;
        if (soil.band > 0) {
          p.band_work[k] += done;
          if (bands != WithBands::none) {
            const std::int32_t slot = state.band_of[p.index[k]];
            if (slot >= 0 && soil.exchange == BandExchange::printed) {
              rise += exchange_as_printed(p, soil, k, p.band_work[k], dt, state) - per_capacity * p.band_work[k];
            } else if (slot >= 0) {
              // (Where nothing slips the deviation only evens out, over longer times than a pass.)
              ShearBand& band = state.bands[std::size_t(slot)];
              const bool waits = bands == WithBands::that_slip && p.band_work[k] == 0 && !soil.by_temperature &&
                                 band.waited < most_waits * dt;
              const double over = band.waited + dt;
              band.waited = waits ? over : 0;
              if (!waits)
                swollen = advance_band(band, soil, p.band_width[k], p.band_work[k] / p.J[k], over, p.temperature[k],
                                       p.temperature[k] + rise);
            }
            p.band_work[k] = 0;
          }
        }
        if (rise == 0 && !(soil.by_temperature && swollen)) continue;
        const double from = p.temperature[k];
        p.temperature[k] += rise;
        if (soil.by_temperature && water) sum.expansion += water->swell(p, k, swollen.value_or(soil.swells(from, from + rise)) * p.J[k]);
        else if (soil.swelling > 0 && water) sum.expansion += water->swell(p, k, soil.swelling * rise * p.J[k]);
        if (!(soil.skeleton > 0) || (opening && (*opening)[k] > 0)) continue;
        const double before = material.energy(all, k), stress = bulk * soil.skeleton * rise;
        for (Array* of : {&p.tau_xx, &p.tau_yy, &p.tau_zz}) (*of)[k] -= stress;
        sum.expansion += p.volume0[k] * (material.energy(all, k) - before);
      }
    });
    for (const HeatSums& part : parts) sums.add(part);
  }
  return sums;
}

// Points with a zone around them that have worked get a band; those that have one keep it.
void Heat::open_bands(const Particles& p, HeatState& state) {
  const Array* work = p.history.find(plastic_work.name);
  for (const Particles::Body& body : p.bodies) {
    const HeatSoil& soil = soils_[std::size_t(body.material)];
    if (!(soil.band > 0)) continue;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      std::int32_t& slot = state.band_of[p.index[k]];
      if (slot >= 0 || p.cell[k] == Particles::ended || !(p.band_width[k] > 0) || !((*work)[k] > p.heated_by[k])) continue;
      slot = std::int32_t(state.bands.size());
      state.bands.emplace_back();
    }
  }
}

// A zone's width follows from the plastic shear of the last looks, the older the less.
void Heat::look_at_zones(Particles& p, const GridState& g, HeatState& state, double time) {
  const Array& strain = *p.history.find(plastic_strain.name);
  work_.assign(p.size(), 0.0);
  sense_.assign(p.size(), 0.0);
  for (const Particles::Body& body : p.bodies) {
    if (!(soils_[std::size_t(body.material)].band > 0)) continue;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      if (p.cell[k] == Particles::ended) continue;
      work_[k] = std::max(0.0, strain[k] - p.sheared[k]);
      p.sheared[k] += forgotten * work_[k];
      sense_[k] = state.turning[p.index[k]].look(p.F_xx[k], p.F_xy[k], p.F_yx[k], p.F_yy[k], forgotten);
    }
  }
  zone_->look(p, g, work_, sense_, time);
}

void Heat::shift_strength(Particles& p, const HeatState& state, int threads) const {
  for (const Particles::Body& body : p.bodies) {
    const HeatSoil& soil = soils_[std::size_t(body.material)];
    if (!(soil.band > 0 && soil.storage > 0)) continue;
    for_each(body.end - body.begin, threads, [&](std::size_t from) {
      const std::size_t k = body.begin + from;
      const std::int32_t slot = state.band_of[p.index[k]];
      if (slot < 0 || p.cell[k] == Particles::ended) return;
      const ShearBand& band = state.bands[std::size_t(slot)];
      p.shift[k] = p.J[k] * (soil.exchange == BandExchange::printed ? std::max(0.0, band.pressure[0] - p.pressure[k]) : band.over_pressure(soil.band));
    });
  }
}

// 4.25 to 4.33: the band's own temperature and pressure, and for the point what it gets of them, K. The same heat a unit of volume
// leaves the one and enters the other, so what is exchanged is not conserved, nor is the water.
double Heat::exchange_as_printed(Particles& p, const HeatSoil& soil, std::size_t k, double work, double dt, HeatState& state) const {
  ShearBand& band = state.bands[std::size_t(state.band_of[p.index[k]])];
  const double area = p.volume0[k] * p.J[k], reference = std::sqrt(area);
  double &hot = band.temperature[0], &pressure = band.pressure[0];
  if (band.width == 0) {
    band.width = reference;
    hot = p.temperature[k];
    pressure = p.pressure.empty() ? 0 : p.pressure[k];
  }
  const double before = hot, exchange = dt * soil.conductivity / area / soil.capacity;
  // (Backward Euler in the band's own: nothing overshoots.)
  hot = (hot + work / soil.capacity * reference / soil.band + exchange * p.temperature[k]) / (1 + exchange);
  const double rise = exchange * (hot - p.temperature[k]);
  if (soil.storage > 0) {
    const double of_water = dt * soil.mobility_at(hot) / area, heated = soil.by_temperature ? soil.swells(before, hot) - soil.skeleton * (hot - before) : soil.pressurising() * (hot - before);
    pressure = (soil.storage * pressure + heated + of_water * p.pressure[k]) / (soil.storage + of_water);
    p.content[k] += p.J[k] * of_water * (pressure - p.pressure[k]);
  }
  return rise;
}

Heat::InBand Heat::in_band(const Particles& p, const HeatState& state, std::size_t k) const {
  InBand at{p.temperature[k], p.pressure.empty() ? 0 : p.pressure[k]};
  const std::int32_t slot = state.band_of.empty() ? -1 : state.band_of[p.index[k]];
  if (slot < 0) return at;
  const HeatSoil& soil = soil_of(p, k);
  const ShearBand& band = state.bands[std::size_t(slot)];
  if (soil.exchange == BandExchange::printed) return band.width > 0 ? InBand{band.temperature[0], band.pressure[0]} : at;
  return {at.temperature + band.hotter(soil.band), at.pressure + band.over_pressure(soil.band)};
}

}  // namespace pivnp::mpm

// What points hold: content, pressure, stress, mass and energy.
#include "mpm/water/pore_water.hpp"

#include <algorithm>
#include <cmath>

#include "mpm/grid/sweeps.hpp"
#include "pivnp/core/error.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::size_t chunk = 1024;   // points

// The sum of what of(k) returns, in an order that does not depend on `threads`.
template <class Of>
double sum_over(std::size_t size, int threads, Of&& of) {
  std::vector<double> parts((size + chunk - 1) / chunk, 0.0);
  for_each(parts.size(), threads, [&](std::size_t part) {
    double sum = 0;
    for (std::size_t k = part * chunk; k < std::min(size, (part + 1) * chunk); ++k) sum += of(k);
    parts[part] = sum;
  });
  double sum = 0;
  for (const double part : parts) sum += part;
  return sum;
}

}  // namespace

PoreWater::PoreWater(const WaterOptions& options, std::vector<PoreSoil> soils, const ParticleSet& particles,
                     const GridState& g, PoreBoundaries boundaries, const TiedSides& ties, const RigidBodies& bodies)
    : options_(options),
      soils_(std::move(soils)),
      set_(&particles),
      boundaries_(std::move(boundaries)),
      level_(options.level_m),
      reference_(g.domain.origin.x(), options.level_m.value_or(g.domain.origin.y())),
      node_(g.grid.node_count()),
      first_i_(int(std::lround((g.domain.origin.x() - g.field_grid.origin.x()) * g.per_hx))),
      first_j_(int(std::lround((g.domain.origin.y() - g.field_grid.origin.y()) * g.per_hy))),
      last_i_(first_i_ + g.domain.nx - 1),
      last_j_(first_j_ + g.domain.ny - 1),
      ties_(&ties),
      bodies_(&bodies) {
  if (std::none_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return s.has_pores(); }))
    throw InputError("water: no material has a porosity, expected one that holds water");
  const Points& at = options.level_history;
  if (!at.empty() && options.level_m) throw InputError("water.level_history: given beside water.level_m, expected one of them");
  for (std::size_t k = 0; k < at.size(); ++k)
    if (!std::isfinite(at[k][0]) || !std::isfinite(at[k][1]) || (k > 0 && !(at[k][0] > at[k - 1][0])))
      throw InputError("water.level_history: entry " + std::to_string(k + 1) + " is not finite or not later than the one before, expected rising times");
  set_time(0);
  if (level_) reference_.y() = *level_;
}

void PoreWater::set_time(double time) {
  const Points& at = options_.level_history;
  if (at.empty()) return;
  std::size_t k = 0;
  while (k < at.size() && at[k][0] <= time) ++k;
  if (k == 0 || k == at.size()) level_ = at[k == 0 ? 0 : k - 1][1];
  else level_ = at[k - 1][1] + (at[k][1] - at[k - 1][1]) * (time - at[k - 1][0]) / (at[k][0] - at[k - 1][0]);
}

double PoreWater::outside_pressure(const Vec2& x, const Vec2& gravity) const {
  return level_ ? options_.density_kg_m3 * -gravity.y() * std::max(0.0, *level_ - x.y()) : 0.0;
}

void PoreWater::start(Particles& p, const GridState& g, const Vec2& gravity, int threads) {
  for (std::size_t k = 0; k < p.size(); ++k) {
    const PoreSoil& soil = soil_of(p, k);
    const Vec2 x(p.x[k], p.y[k]);
    const bool full = soil.has_pores() && (!level_ || x.y() < *level_);
    p.content[k] = full ? soil.porosity * (1 + outside_pressure(x, gravity) / options_.bulk_modulus_pa) : 0;
    p.porosity[k] = soil.porosity;
    if (soil.has_pores()) p.mass[k] = p.volume0[k] * (soil.dry_density() + options_.density_kg_m3 * p.content[k]);
  }
  refresh(p, gravity, threads);
  std::vector<std::uint8_t> full(g.grid.node_count(), 0);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const Vec2 at = (Vec2(p.x[k], p.y[k]) - g.field_grid.origin).cwiseQuotient(g.field_grid.spacing);
    full[g.field_grid.node(std::min(int(at.x()), g.field_grid.nx - 2), std::min(int(at.y()), g.field_grid.ny - 2))] = 1;
  }
  boundaries_.check_outside(g, [&](std::size_t n) { return full[n] != 0; });
}

void PoreWater::refresh_point(Particles& p, std::size_t k, const PoreSoil& soil, const Vec2& gravity) const {
  const double J = p.J[k], outside = outside_pressure({p.x[k], p.y[k]}, gravity);
  if (!soil.has_pores()) {
    p.pressure[k] = 0;
  } else {
    const bool holds = p.content[k] > 0 && soil.holds_water();
    p.porosity[k] = 1 - (1 - soil.porosity) / J;
    p.pressure[k] = holds ? options_.bulk_modulus_pa * (p.content[k] / pores_of(p, k, soil) - 1) : outside;
  }
  const double excess = J * (p.pressure[k] - outside);
  p.total_xx[k] = p.tau_xx[k] - excess;
  p.total_yy[k] = p.tau_yy[k] - excess;
  p.total_zz[k] = p.tau_zz[k] - excess;
}

void PoreWater::refresh(Particles& p, const Vec2& gravity, int threads) const {
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    for_each(body.end - body.begin, threads, [&](std::size_t k) {
      if (p.cell[body.begin + k] != Particles::ended) refresh_point(p, body.begin + k, soil, gravity);
    });
  }
}

void PoreWater::lift(const Particles& p, GridState& g, const Vec2& gravity, int threads) const {
  const double weight = options_.density_kg_m3 * -gravity.y();
  Shapes::with(g.shape, [&](auto kind) {
    using S = decltype(kind);
    for_bands(g.active.mapped, threads, [&](Range range, std::size_t) {
      for_points<S>(p, g, range, [&](std::uint32_t k, const std::size_t* at, const auto& x, const auto& y) {
        if (p.y[k] >= *level_) return;
        const double up = p.volume0[k] * p.J[k] * weight;
        for (int c = 0; c < S::width * S::width; ++c) g.node[at[c]].fy += up * x.w[c % S::width] * y.w[c / S::width];
      });
    });
  });
}

std::vector<double> PoreWater::displaced_mass(const Particles& p) const {
  std::vector<double> mass(p.size(), 0.0);
  for (std::size_t k = 0; k < p.size(); ++k)
    if (level_ && p.y[k] < *level_) mass[k] = options_.density_kg_m3 * p.volume0[k] * p.J[k];
  return mass;
}

double PoreWater::mass(const Particles& p, std::size_t k) const {
  return flows(p, k) ? p.volume0[k] * (soil_of(p, k).dry_density() + options_.density_kg_m3 * p.content[k]) : p.mass[k];
}

double PoreWater::potential_energy(const Particles& p, std::size_t k, const Vec2& gravity) const {
  return p.volume0[k] * p.J[k] * outside_pressure({p.x[k], p.y[k]}, gravity) - p.mass[k] * gravity.dot(p.displacement(k, reference_));
}

double PoreWater::potential_energy(const Particles& p, const Vec2& gravity, int threads) const {
  return sum_over(p.size(), threads, [&](std::size_t k) { return p.cell[k] == Particles::ended ? 0 : potential_energy(p, k, gravity); });
}

double PoreWater::stored(const Particles& p, std::size_t k) const {
  if (!flows(p, k)) return 0;
  return p.volume0[k] * pores_of(p, k, soil_of(p, k)) * p.pressure[k] * p.pressure[k] / (2 * options_.bulk_modulus_pa);
}

PoreWater::Sums PoreWater::sums(const Particles& p) const {
  Sums all;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended || !flows(p, k)) continue;
    all.energy += stored(p, k);
    all.mass += flowing_mass(p, k);
  }
  return all;
}

PoreWater::Rates PoreWater::rates(const Particles& p) const {
  Rates rates;
  rates.stiffness.assign(soils_.size(), 0.0);
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    if (!soil.holds_water()) continue;
    double& stiffness = rates.stiffness[std::size_t(body.material)];
    double least = 1, mobility = 0;
    for (std::size_t k = body.begin; k < body.end; ++k) {
      if (p.cell[k] == Particles::ended || !(p.content[k] > 0)) continue;
      const double pores = pores_of(p, k, soil);
      stiffness = std::max(stiffness, options_.bulk_modulus_pa * p.J[k] * p.J[k] / pores);
      least = std::min(least, pores / p.J[k]);
      mobility = std::max(mobility, mobility_of(p, k));
    }
    if (stiffness > 0) rates.diffusivity = std::max(rates.diffusivity, mobility * options_.bulk_modulus_pa / least);
  }
  return rates;
}

bool PoreWater::partly_dry(const Particles& p, std::size_t material) const {
  for (const Particles::Body& body : p.bodies)
    if (std::size_t(body.material) == material && soils_[material].has_pores())
      return std::any_of(p.content.begin() + std::ptrdiff_t(body.begin), p.content.begin() + std::ptrdiff_t(body.end),
                         [](double content) { return !(content > 0); });
  return false;
}

}  // namespace pivnp::mpm

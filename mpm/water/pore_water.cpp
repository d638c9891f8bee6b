// What points hold: content, pressure, stress, mass and energy.
#include "mpm/water/pore_water.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/sweeps.hpp"
#include "mpm/water/water_properties.hpp"
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

// Room before the first node, and for fields behind the last one: a row and more is read there.
std::size_t before_nodes(const GridState& g) { return std::size_t(g.grid.nx) + 8; }

double mobility_in_kernels(const PoreSoil& soil) {
  return soil.holds_water() ? soil.mobility : soil.has_pores() ? drained_mobility : no_pores_mobility;
}

}  // namespace

PoreWater::PoreWater(const WaterOptions& options, std::vector<PoreSoil> soils, const ParticleSet& particles,
                     GridState& g, PoreBoundaries boundaries, const TiedSides& ties, const RigidBodies& bodies)
    : options_(options),
      soils_(std::move(soils)),
      set_(&particles),
      boundaries_(std::move(boundaries)),
      level_(options.level_m),
      reference_(g.domain.origin.x(), options.level_m.value_or(g.domain.origin.y())),
      ties_(&ties),
      bodies_(&bodies),
      first_i_(int(std::lround((g.domain.origin.x() - g.field_grid.origin.x()) * g.per_hx))),
      first_j_(int(std::lround((g.domain.origin.y() - g.field_grid.origin.y()) * g.per_hy))),
      last_i_(first_i_ + g.domain.nx - 1),
      last_j_(first_j_ + g.domain.ny - 1) {
  if (std::none_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return s.has_pores(); }))
    throw InputError("water: no material has a porosity, expected one that holds water");
  const Points& at = options.level_history;
  if (!at.empty() && options.level_m) throw InputError("water.level_history: given beside water.level_m, expected one of them");
  for (std::size_t k = 0; k < at.size(); ++k)
    if (!std::isfinite(at[k][0]) || !std::isfinite(at[k][1]) || (k > 0 && !(at[k][0] > at[k - 1][0])))
      throw InputError("water.level_history: entry " + std::to_string(k + 1) + " is not finite or not later than the one before, expected rising times");
  if (imposed() && !options.level_m && at.empty())
    throw InputError("water.groundwater: found 'level' without a level, expected water.level_m or level_history");
  if (imposed() && !options.surface_m.empty()) throw InputError("water.surface_m: given beside water.groundwater = \"level\", expected one of them");
  if (imposed() && boundaries_.any_level())
    throw InputError("water.groundwater: found 'level' beside a boundary with water_level_m, expected 'flow'");
  const std::size_t before = before_nodes(g);
  const auto field = [&](std::size_t k) { return g.arrays.flow[k].data() + before; };
  const auto weight = [&](std::size_t k) { return g.arrays.flow_weights[k].data() + before; };
  double* rate = g.arrays.flow_rate.size() > 0 ? g.arrays.flow_rate.data() + before : nullptr;
  field_ = {field(0), field(1), field(2), field(3), field(4), rate, weight(0), weight(1), weight(2), weight(3), weight(4), nullptr, nullptr, g.grid.nx};
  if (g.axisymmetric) set_rings(g);
  sums_ = {g.arrays.pores.data() + before, g.arrays.pore_elements.data() + before};
  marks_ = g.arrays.pore_marks.data() + before;
  set_time(0);
  if (level_) reference_.y() = *level_;
  else if (!options.surface_m.empty()) reference_.y() = surface_at(reference_.x());
}

// An element from r to r + h has h (r/2 + h/6) and h (r/2 + h/3) of its volume at its inner and outer nodes.
void PoreWater::set_rings(GridState& g) {
  const double h = g.grid.spacing.x();
  const auto field = [&](std::size_t k) { return g.arrays.rings[k].data() + before_nodes(g); };
  field_.radius = field(0);
  field_.of_right = field(1);
  field_.of_left = field(2);
  for (std::size_t n = 0; n < g.grid.node_count(); ++n) {
    const double r = g.position(n).x();
    field(0)[n] = std::max(r, h / 3);
    field(1)[n] = 0.5 - h / (12 * std::max(r + h / 2, h / 2));
    field(2)[n] = 0.5 + h / (12 * std::max(r - h / 2, h / 2));
  }
}

double PoreWater::level_at(double time) const {
  const Points& at = options_.level_history;
  if (at.empty()) return *options_.level_m;
  std::size_t k = 0;
  while (k < at.size() && at[k][0] <= time) ++k;
  if (k == 0 || k == at.size()) return at[k == 0 ? 0 : k - 1][1];
  return at[k - 1][1] + (at[k][1] - at[k - 1][1]) * (time - at[k - 1][0]) / (at[k][0] - at[k - 1][0]);
}

void PoreWater::set_time(double time) {
  if (!options_.level_history.empty()) level_ = level_at(time);
}

// What comes in, or leaves, is what raises the pressure of a layer under constant total stress: it fits the compression of the water and
// the swelling of the skeleton, which gives way by as much as the effective stress falls.
PoreFlow PoreWater::follow_level(Particles& p, const Vec2& gravity, double from, double to, int threads) const {
  if (!imposed() || !level_moves() || !(gravity.y() < 0)) return {};
  const double before = level_at(from), after = level_at(to), weight = options_.density_kg_m3 * -gravity.y();
  if (before == after) return {};
  std::vector<PoreFlow> parts((p.size() + chunk - 1) / chunk);
  for_each(parts.size(), threads, [&](std::size_t part) {
    for (std::size_t k = part * chunk; k < std::min(p.size(), (part + 1) * chunk); ++k) {
      if (p.cell[k] == Particles::ended || !flows(p, k)) continue;
      const double more = weight * (std::max(0.0, after - p.y[k]) - std::max(0.0, before - p.y[k]));
      if (more == 0) continue;
      const PoreSoil& soil = soil_of(p, k);
      const double stored_before = stored(p, k, gravity);
      const double volume = p.volume0[k] * more * (pores_of(p, k, soil) / options_.bulk_modulus_pa + p.J[k] / soil.constrained_modulus);
      p.content[k] += volume / p.volume0[k];
      p.pressure[k] = pressure_of(p, k, true);
      parts[part].inflow += volume;
      parts[part].external += stored(p, k, gravity) - stored_before;
    }
  });
  PoreFlow sum;
  for (const PoreFlow& part : parts) sum.add(part);
  return sum;
}

double PoreWater::outside_pressure(const Vec2& x, const Vec2& gravity) const {
  return level_ ? options_.density_kg_m3 * -gravity.y() * std::max(0.0, *level_ - x.y()) : 0.0;
}

// Kernels see one soil, or what every point has of its own.
void PoreWater::take_soils(Particles& p) {
  const bool varied = p.bodies.size() > 1 || std::any_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return s.kozeny_carman; }) || by_temperature();
  alike_ = {mobility_in_kernels(soil_of(p, 0)), 1 - soil_of(p, 0).porosity, varied};
  p.mobility.assign(varied ? p.size() : 0, 0.0);
  p.solid.assign(varied ? p.size() : 0, 0.0);
  const bool drains = std::any_of(soils_.begin(), soils_.end(), [](const PoreSoil& s) { return s.drained; });
  p.displacing.assign(drains ? p.size() : 0, 1.0);
  for (std::size_t k = 0; k < p.displacing.size(); ++k)
    if (soil_of(p, k).drained) p.displacing[k] = 0;
  for (std::size_t k = 0; k < p.mobility.size(); ++k) {
    const PoreSoil& soil = soil_of(p, k);
    p.mobility[k] = mobility_in_kernels(soil);
    p.solid[k] = 1 - soil.porosity;
  }
}

void PoreWater::follow_porosity(Particles& p, int threads) const {
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    if (!soil.kozeny_carman || !soil.holds_water()) continue;
    for_each(body.end - body.begin, threads, [&](std::size_t k) {
      p.mobility[body.begin + k] = thinned(p, body.begin + k) * soil.mobility_at(1 - (1 - soil.porosity) / p.J_flow[body.begin + k]);
    });
  }
}

double PoreWater::thinned(const Particles& p, std::size_t k) const {
  return reference_viscosity_ > 0 ? reference_viscosity_ / water_viscosity(p.temperature[k]) : 1;
}

void PoreWater::take_reference_temperature(Particles& p, double celsius) {
  if (!by_temperature()) return;
  reference_viscosity_ = water_viscosity(celsius);
  follow_temperature(p, 1);
}

void PoreWater::follow_temperature(Particles& p, int threads) const {
  if (!by_temperature()) return;
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    if (!soil.holds_water()) continue;
    for_each(body.end - body.begin, threads, [&](std::size_t from) {
      const std::size_t k = body.begin + from;
      p.mobility[k] = thinned(p, k) * soil.mobility_at(1 - (1 - soil.porosity) / p.J_flow[k]);
    });
  }
}

PoreView PoreWater::view(const Particles& p, const Vec2& gravity) const {
  const auto at = [](const Array& values) { return values.empty() ? nullptr : const_cast<double*>(values.data()); };
  const double density = options_.density_kg_m3;
  return {at(p.pressure), at(p.content), at(p.J_flow), at(p.mobility), at(p.solid), alike_.mobility, alike_.solid,
          options_.bulk_modulus_pa, density * gravity.x(), density * gravity.y(), -density * gravity.dot(reference_), p.outside, p.level, projected(), p.swelling.empty() ? nullptr : p.swelling.data(), !p.swelling.empty() && !projected(), tears()};
}

double PoreWater::porosity(const Particles& p, std::size_t k) const {
  const PoreSoil& soil = soil_of(p, k);
  return soil.has_pores() ? 1 - (1 - soil.porosity) / p.J[k] : 0;
}

// As contents have it. `tears`: water that does not fill its pores bears no tension.
double PoreWater::pressure_of(const Particles& p, std::size_t k, bool tears) const {
  const double water = p.swelling.empty() ? p.content[k] : p.content[k] + p.swelling[k];
  const double pressure = options_.bulk_modulus_pa * (water / pores_of(p, k, soil_of(p, k)) - 1);
  return tears ? std::max(0.0, pressure) : pressure;
}

void PoreWater::refresh_point(Particles& p, std::size_t k, const PoreSoil& soil, const Vec2& gravity) const {
  const double outside = outside_pressure({p.x[k], p.y[k]}, gravity);
  const bool air = sees_air(gravity), holds = (air || p.content[k] > 0) && soil.holds_water();
  p.pressure[k] = holds ? pressure_of(p, k, air || tears()) : soil.has_pores() ? outside : 0;
  p.J_flow[k] = p.J[k];
  if (!p.J_strained.empty()) p.J_strained[k] = p.J[k];
}

void PoreWater::refresh(Particles& p, const Vec2& gravity, int threads) const {
  set_outside(p, gravity);
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    for_each(body.end - body.begin, threads, [&](std::size_t k) {
      if (p.cell[body.begin + k] != Particles::ended) refresh_point(p, body.begin + k, soil, gravity);
    });
  }
}

void PoreWater::set_outside(Particles& p, const Vec2& gravity) const {
  p.outside = level_ ? options_.density_kg_m3 * -gravity.y() : 0;
  p.level = level_.value_or(0);
}

std::vector<double> PoreWater::displaced_mass(const Particles& p) const {
  std::vector<double> mass(p.size(), 0.0);
  for (std::size_t k = 0; k < p.size(); ++k)
    if (level_ && p.y[k] < *level_)
      mass[k] = options_.density_kg_m3 * p.volume0[k] * (soil_of(p, k).drained ? 1 : p.J[k]);
  return mass;
}

double PoreWater::mass(const Particles& p, std::size_t k) const {
  const PoreSoil& soil = soil_of(p, k);
  if (flows(p, k) || owes(p, k)) return p.volume0[k] * (soil.dry_density() + options_.density_kg_m3 * p.content[k]);
  if (!soil.drained || !level_) return p.mass[k];
  return p.volume0[k] * (soil.dry_density() + (p.y[k] < *level_ ? options_.density_kg_m3 * soil.porosity : 0));
}

double PoreWater::potential_energy(const Particles& p, std::size_t k, const Vec2& gravity) const {
  const Vec2 x(p.x[k], p.y[k]);
  // (Drained pores change places with the water outside at its pressure: that takes no work but the lift's.)
  const double volume = p.volume0[k] * (soil_of(p, k).drained ? 1 : p.J[k]);
  return volume * outside_pressure(x, gravity) -
         (flows(p, k) || owes(p, k) ? mass(p, k) : p.mass[k]) * gravity.dot(x - reference_);
}

// (As of each point, without looking for its soil.)
double PoreWater::potential_energy(const Particles& p, const Vec2& gravity, int threads) const {
  double sum = 0;
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    const bool drained = soil.drained, holds = soil.holds_water(), front = !front_.empty();
    const double dry = soil.dry_density();
    sum += sum_over(body.end - body.begin, threads, [&](std::size_t from) {
      const std::size_t k = body.begin + from;
      if (p.cell[k] == Particles::ended) return 0.0;
      const Vec2 x(p.x[k], p.y[k]);
      const bool has_water = holds && (p.content[k] != 0 || front);
      const double of_mass = has_water ? p.volume0[k] * (dry + options_.density_kg_m3 * p.content[k]) : p.mass[k];
      return p.volume0[k] * (drained ? 1 : p.J[k]) * outside_pressure(x, gravity) -
             of_mass * gravity.dot(x - reference_);
    });
  }
  return sum;
}

double PoreWater::stored(const Particles& p, std::size_t k, const Vec2& gravity) const {
  if (!flows(p, k)) return 0;
  if (const double lack = 1 - filled(p, k); lack > 0 && sees_air(gravity))
    return p.volume0[k] * pores_of(p, k, soil_of(p, k)) * fringe(p, k, gravity) * lack * lack / 2;
  // The flow has not met the last strain yet. Projected, what pressure that will make is not known, but the work on it
  // is.
  const double now = projected() ? p.pressure[k] : pressure_of(p, k, tears());
  const double ahead = projected() ? p.pressure[k] * (p.J[k] - p.J_flow[k]) : 0;
  return p.volume0[k] * (pores_of(p, k, soil_of(p, k)) * now * now / (2 * options_.bulk_modulus_pa) - ahead);
}

double PoreWater::swell(Particles& p, std::size_t k, double by) const {
  if (!flows(p, k)) return 0;
  const double before = stored(p, k, Vec2::Zero()), pressure = p.pressure[k];
  p.swelling[k] += by;
  if (!projected()) p.J_flow[k] += by;  // the next flow smooths it as it smooths strain
  p.pressure[k] = tears() ? pressure_of(p, k, true) : pressure + options_.bulk_modulus_pa / pores_of(p, k, soil_of(p, k)) * by;
  return stored(p, k, Vec2::Zero()) - before;
}

PoreWater::Sums PoreWater::sums(const Particles& p, const Vec2& gravity) const {
  Sums all;
  for (std::size_t k = 0; k < p.size(); ++k) {
    if (p.cell[k] == Particles::ended) continue;
    all.mass += flowing_mass(p, k);
    if (!flows(p, k)) continue;
    all.energy += stored(p, k, gravity);
    const double excess = excess_pressure(p, k, gravity), volume = p.volume0[k];
    all.excess += volume * excess;
    all.excess2 += volume * excess * excess;
    all.volume += volume;
  }
  return all;
}

// Does its water bear nothing, and will it not within some steps? (Single points that are compressed far hold too
// little: they would shorten the steps of all.)
bool PoreWater::torn(const Particles& p, std::size_t k, const PoreSoil& soil) const {
  constexpr double gap = 0.05;  // of the pores
  return tears() && p.content[k] + (p.swelling.empty() ? 0 : p.swelling[k]) < (1 - gap) * pores_of(p, k, soil);
}

PoreWater::Rates PoreWater::rates(const Particles& p) const {
  Rates rates;
  rates.stiffness.assign(soils_.size(), 0.0);
  for (const Particles::Body& body : p.bodies) {
    const PoreSoil& soil = soils_[std::size_t(body.material)];
    for (std::size_t k = body.begin; k < body.end && soil.has_pores(); ++k)
      if (p.cell[k] != Particles::ended)
        rates.least_pores = std::min(rates.least_pores, (p.J[k] - (1 - soil.porosity)) / soil.porosity);
    if (!soil.holds_water()) continue;
    double least = std::numeric_limits<double>::max(), stiffest = 0, mobility = soil.mobility;
    const double solid = 1 - soil.porosity, dry = soil.dry_density(),
                 full = dry + options_.density_kg_m3 * soil.porosity;
    const auto pores = [&](double J) { return std::max(least_pores, J - solid); };
    for (std::size_t k = body.begin; k < body.end; ++k) {
      if (p.cell[k] == Particles::ended || !(p.content[k] > 0)) continue;
      const bool open = torn(p, k, soil);  // (as if it were whole)
      const double J = open ? 1 : p.J[k];
      least = std::min(least, J);
      // Of the point's own mass, which grows with the water that comes.
      const double lighter = open ? 1 : full / (dry + options_.density_kg_m3 * p.content[k]);
      stiffest = std::max(stiffest, J * J / pores(J) * lighter);
    }
    if (!(stiffest > 0)) continue;
    if (soil.kozeny_carman || by_temperature()) mobility = *std::max_element(p.mobility.begin() + std::ptrdiff_t(body.begin), p.mobility.begin() + std::ptrdiff_t(body.end));
    const double stiffness = options_.bulk_modulus_pa * stiffest;
    double& of_material = rates.stiffness[std::size_t(body.material)];
    of_material = std::max(of_material, stiffness);
    rates.diffusivity = std::max(rates.diffusivity, mobility * options_.bulk_modulus_pa * least / pores(least));
  }
  return rates;
}

bool PoreWater::overdrawn(const Particles& p) const {
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p.content[k] < 0 && p.cell[k] != Particles::ended) return true;
  return false;
}

bool PoreWater::partly_dry(const Particles& p, std::size_t material) const {
  for (const Particles::Body& body : p.bodies)
    if (std::size_t(body.material) == material && soils_[material].has_pores())
      return std::any_of(p.content.begin() + std::ptrdiff_t(body.begin), p.content.begin() + std::ptrdiff_t(body.end),
                         [](double content) { return !(content > 0); });
  return false;
}

}  // namespace pivnp::mpm

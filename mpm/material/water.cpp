#include "mpm/material/water.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

namespace {

// The places in the history that water_model() declares.
enum Number : std::size_t { opening, work };

constexpr double still_shear = 1e-6;  // shear over bulk modulus in the initial equilibrium

Elastic without_shear(double bulk) {
  Elastic e;
  e.lambda = bulk;
  e.poisson = 0.5;
  return e;
}

// c^2 rho that gives, by courant h/c, the step of a wave with viscosity: 2/omega (sqrt(1 + xi^2) - xi), omega = 2 c/h and
// xi = (4/3 eta/rho)/(c h).
double stiffness_of(double bulk, double viscosity, double density, double cell) {
  if (!(viscosity > 0) || !(cell > 0)) return bulk;
  const double xi = 4.0 / 3 * viscosity / (std::sqrt(bulk * density) * cell), factor = std::sqrt(1 + xi * xi) + xi;
  return bulk * factor * factor;
}

std::unique_ptr<Material> make(const MaterialOptions& o, double cell_m) {
  return std::make_unique<Water>(o.bulk_pa, o.own_value("viscosity_pa_s").value_or(0), o.density_kg_m3, cell_m);
}

}  // namespace

MaterialModel water_model() {
  const MaterialKey viscosity{
      .name = "viscosity_pa_s",
      .own = OptionInfo{.unit = "Pa s", .text = "dynamic viscosity (water: 1e-3); default: none", .min = 0}};
  return {.name = "water",
          .text = "elastic in volume, no tension, no shear stress but that of viscosity",
          .keys = {{"bulk_pa", true}, viscosity},
          .history = {opening_strain, plastic_work},
          .elastic_keys = false,
          .make = make};
}

Water::Water(double bulk_pa, double viscosity_pa_s, double density_kg_m3, double cell_m)
    : Material(without_shear(bulk_pa)),
      bulk_(bulk_pa),
      viscosity_(viscosity_pa_s),
      stiffness_(stiffness_of(bulk_pa, viscosity_pa_s, density_kg_m3, cell_m)) {}

void Water::update(const StressBatch& b) const {
  const double third = 1.0 / 3, per_bulk = 1 / bulk_;
  const double two_shear = b.dt > 0 ? 2 * viscosity_ / b.dt : 2 * still_shear * bulk_;
  const bool still = !(b.dt > 0), shears = still || viscosity_ > 0;
  double *open = b.history[opening], *dissipated = b.history[work];
  for (std::size_t q = 0; q < b.size; ++q) {
    const std::size_t k = b.places ? b.places[q] : q;
    const double volumetric = b.de_xx[q] + b.de_yy[q] + b.de_zz[q], before = third * (b.xx[k] + b.yy[k] + b.zz[k]);
    const double strain = (open[k] > 0 ? open[k] : before * per_bulk) + volumetric;
    open[k] = std::max(0.0, strain);
    const double mean = bulk_ * std::min(0.0, strain);
    if (!shears || open[k] > 0) {
      b.xx[k] = b.yy[k] = b.zz[k] = mean;
      b.xy[k] = 0;
      continue;
    }
    const double scale = still ? two_shear : two_shear * b.J[k];
    const double exx = b.de_xx[q] - third * volumetric, eyy = b.de_yy[q] - third * volumetric, ezz = b.de_zz[q] - third * volumetric;
    double xx = scale * exx, yy = scale * eyy, zz = scale * ezz, xy = scale * b.de_xy[q];
    if (still) {
      xx += b.xx[k] - before;
      yy += b.yy[k] - before;
      zz += b.zz[k] - before;
      xy += b.xy[k];
    } else {
      dissipated[k] += xx * exx + yy * eyy + zz * ezz + 2 * xy * b.de_xy[q];
    }
    b.xx[k] = mean + xx;
    b.yy[k] = mean + yy;
    b.zz[k] = mean + zz;
    b.xy[k] = xy;
  }
}

double Water::energy(const StressBatch& batch, std::size_t k) const {
  const double mean = (batch.xx[k] + batch.yy[k] + batch.zz[k]) / 3;
  return 0.5 * mean * mean / bulk_;
}

double Water::stiffness(const StressBatch&) const { return stiffness_; }

}  // namespace pivnp::mpm

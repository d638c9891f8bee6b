#include "mpm/material/drucker_prager.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/material/strength.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::mpm {

namespace {

std::unique_ptr<Material> make_drucker_prager(const MaterialOptions& o, double) {
  return std::make_unique<DruckerPrager>(Elastic(o.young_pa, o.poisson), o.friction_deg, o.dilatancy_deg, o.cohesion_pa,
                                         o.tension_pa, DruckerPrager::Flow{});
}

std::unique_ptr<Material> make_mu_i(const MaterialOptions& o, double) {
  const DruckerPrager::Flow flow{*o.friction_flow_deg, o.inertial_number, o.grain_diameter_m, o.grain_density_kg_m3};
  return std::make_unique<DruckerPrager>(Elastic(o.young_pa, o.poisson), o.friction_deg, 0, 0, 0, flow);
}

void check_mu_i(const MaterialOptions& o) {
  require(o.friction_deg > 0, "friction_deg", o.friction_deg, "an angle above 0");
  require(*o.friction_flow_deg >= o.friction_deg, "friction_flow_deg", *o.friction_flow_deg, "friction_deg or more");
  require(o.cohesion_pa == 0, "cohesion_pa", o.cohesion_pa, "0 with mu_i");
  require(o.dilatancy_deg == 0, "dilatancy_deg", o.dilatancy_deg, "0 with mu_i");
}

}  // namespace

MaterialModel drucker_prager_model() {
  return {.name = "drucker_prager",
          .text = "the cone with Mohr-Coulomb's strength in plane strain",
          .keys = cone_keys(),
          .history = cone_history(),
          .check = check_cone,
          .make = make_drucker_prager,
          .reduce = reduce_cone};
}

MaterialModel mu_i_model() {
  return {.name = "mu_i",
          .text = "dry granular flow, whose friction grows with the rate",
          .keys = {{"friction_deg"}, {"friction_flow_deg", true, true}, {"inertial_number"}, {"grain_diameter_m", true},
                   {"grain_density_kg_m3"}},
          .history = cone_history(),
          .check = check_mu_i,
          .make = make_mu_i,
          .reduce = reduce_cone};
}

DruckerPrager::DruckerPrager(const Elastic& elastic, double friction_deg, double dilatancy_deg, double cohesion_pa,
                             double tension_pa, const Flow& flow)
    : Material(elastic), tension_(tension_pa), bulk_(elastic.lambda + 2.0 / 3 * elastic.shear) {
  const double tan_psi = std::tan(radians(dilatancy_deg)), sin_phi = std::sin(radians(friction_deg));
  beta_ = 3 * tan_psi / std::sqrt(9 + 12 * tan_psi * tan_psi);
  const double D = std::sqrt(1 - beta_ * beta_ / 3) + beta_ * sin_phi / 3;
  alpha_ = sin_phi / D;
  k_ = cohesion_pa * std::cos(radians(friction_deg)) / D;
  if (flow.friction_deg > 0) {
    alpha_flow_ = std::sin(radians(flow.friction_deg));
    inertial_number_ = flow.inertial_number;
    per_diameter_ = 1 / flow.diameter_m;
    grain_density_ = flow.grain_density;
  }
}

// bar = trial - G dt g with bar = mu(I) p: with g = (trial - bar)/(G dt) a quadratic in bar (Dunatunga & Kamrin, 2.24).
double DruckerPrager::flowing_bar(double trial, double pressure, double J, double dt) const {
  const double least = alpha_ * pressure, most = alpha_flow_ * pressure;
  if (!(pressure > 0) || !(dt > 0)) return std::max(0.0, least);
  const double viscous = elastic_.shear * inertial_number_ * dt * std::sqrt(pressure / (J * grain_density_)) * per_diameter_;
  const double b = most + trial + viscous, h = most * trial + least * viscous;
  return 2 * h / (b + std::sqrt(std::max(0.0, b * b - 4 * h)));
}

void DruckerPrager::return_point(const StressBatch& batch, std::size_t k, const Stress& trial) const {
  const double J = batch.J[k], mean = (trial.xx + trial.yy + trial.zz) / 3;
  const double dxx = trial.xx - mean, dyy = trial.yy - mean, dzz = trial.zz - mean;
  const double bar = std::sqrt(0.5 * (dxx * dxx + dyy * dyy + dzz * dzz) + trial.xy * trial.xy);
  const double apex = alpha_ > 0 ? k_ * J / alpha_ : std::numeric_limits<double>::infinity();
  const double most_mean = std::min(batch.flags[plastic::separated][k] ? 0.0 : tension_ * J, apex);
  const double excess = bar + alpha_ * mean - k_ * J;
  if (excess <= 0 && mean <= most_mean) return store(batch, k, trial);

  double new_mean = mean, new_bar = bar;
  if (excess > 0) {
    const double amount = excess / (elastic_.shear + bulk_ * alpha_ * beta_);
    new_bar = bar - amount * elastic_.shear;
    new_mean = mean - amount * bulk_ * beta_;
    if (alpha_flow_ > 0) new_bar = std::min(bar, flowing_bar(bar, -mean, J, batch.dt));
  }
  bool opens = false;
  if (new_mean > most_mean || new_bar < 0) {
    new_mean = most_mean;
    new_bar = std::clamp(k_ * J - alpha_ * new_mean, 0.0, bar);
    opens = new_bar <= 1e-9 * std::abs(most_mean) || alpha_ * std::abs(k_) == 0;
  }
  const double keep = bar > 0 ? new_bar / bar : 0;
  const Stress to{new_mean + keep * dxx, new_mean + keep * dyy, new_mean + keep * dzz, keep * trial.xy};
  const double slip = (bar - new_bar) / (2 * elastic_.shear), volume = (mean - new_mean) / bulk_;
  batch.history[plastic::strain][k] += 2 / std::numbers::sqrt3 * slip;
  batch.history[plastic::work][k] += 2 * new_bar * slip + new_mean * volume;
  if (opens && volume > 0) {
    batch.history[plastic::opening][k] = volume;
    batch.flags[plastic::separated][k] = 1;
  }
  store(batch, k, to);
}

void DruckerPrager::update(const StressBatch& batch) const {
  for (std::size_t k = 0; k < batch.size; ++k) {
    if (batch.history[plastic::opening][k] == 0) {
      return_point(batch, k, elastic_trial(elastic_, batch, k));
      continue;
    }
    const double volumetric = batch.de_xx[k] + batch.de_yy[k] + batch.de_zz[k], left = batch.history[plastic::opening][k] + volumetric;
    Stress trial{0, 0, 0, 0};
    batch.history[plastic::work][k] += elastic_.energy(batch.xx[k], batch.yy[k], batch.zz[k], batch.xy[k]);
    batch.history[plastic::opening][k] = std::max(0.0, left);
    if (left > 0) {
      store(batch, k, trial);
      continue;
    }
    const double share = volumetric < 0 ? left / volumetric : 0;
    add_elastic(elastic_, share * batch.de_xx[k], share * batch.de_yy[k], share * batch.de_zz[k],
                share * batch.de_xy[k], trial);
    return_point(batch, k, trial);
  }
}

}  // namespace pivnp::mpm

#include "mpm/material/strength.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pivnp/core/text.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::mpm {

std::vector<MaterialKey> cone_keys() {
  return {{"friction_deg"}, {"dilatancy_deg"}, {"cohesion_pa"}, {"tension_pa"}};
}

std::vector<HistoryVariable> cone_history() {
  return {plastic_strain, plastic_work, opening_strain,
          {.name = "separated", .definition = "1 once the point has opened: no tension any more", .form = FieldForm::code}};
}

void check_cone(const MaterialOptions& o) {
  require(o.friction_deg > 0 || o.cohesion_pa > 0, "friction_deg", o.friction_deg, "more than 0, or cohesion_pa of more than 0");
  require_order(o, "dilatancy_deg", "friction_deg");
}

void reduce_cone(MaterialOptions& o, double factor) {
  constexpr double degree = std::numbers::pi / 180;
  const auto angle = [&](double& deg) { deg = std::atan(std::tan(deg * degree) / factor) / degree; };
  const auto maybe = [&](std::optional<double>& deg) {
    if (deg) angle(*deg);
  };
  angle(o.friction_deg);
  maybe(o.friction_residual_deg);
  maybe(o.friction_low_stress_deg);
  maybe(o.friction_flow_deg);
  o.dilatancy_deg = std::min(o.dilatancy_deg, o.friction_deg);
  o.cohesion_pa /= factor;
  if (o.cohesion_residual_pa) *o.cohesion_residual_pa /= factor;
  o.tension_pa /= factor;
}

std::vector<MaterialKey> soil_keys() {
  std::vector<MaterialKey> keys = cone_keys();
  for (const char* key : {"friction_residual_deg", "cohesion_residual_pa", "softening_shape", "softening_length_m",
                          "softening_average", "friction_low_stress_deg", "friction_half_pa", "dilatancy_fade"})
    keys.push_back({.name = key, .exclusive = true});
  return keys;
}

void check_soil(const MaterialOptions& o) {
  check_cone(o);
  const bool softens = o.friction_residual_deg || o.cohesion_residual_pa;
  require_order(o, "friction_residual_deg", "friction_deg");
  require_order(o, "cohesion_residual_pa", "cohesion_pa");
  require(!softens || o.softening_shape > 0, "softening_shape", o.softening_shape, "a rate above 0 beside a residual strength");
  require(softens || o.softening_shape == 0, "softening_shape", o.softening_shape,
          "friction_residual_deg or cohesion_residual_pa beside it");
  if (o.softening_length_m) require(softens, "softening_length_m", *o.softening_length_m, "a residual strength beside it");
  if (o.softening_average == SofteningAverage::nonlocal && !o.softening_length_m)
    throw MaterialFault("softening_length_m", "missing beside softening_average = \"nonlocal\"");
  if (o.friction_low_stress_deg.has_value() != o.friction_half_pa.has_value())
    throw MaterialFault(o.friction_half_pa ? "friction_half_pa" : "friction_low_stress_deg",
                        "given alone, expected friction_low_stress_deg and friction_half_pa");
  if (!o.friction_low_stress_deg) return;
  const double low = *o.friction_low_stress_deg, residual = o.friction_residual_deg.value_or(o.friction_deg);
  require(low >= o.friction_deg, "friction_low_stress_deg", low, "friction_deg or more");
  // Strength must grow with pressure: tan phi > |d phi / d ln p|, at most (phi_low - phi_high)/4.
  require(std::tan(radians(residual)) > 0.25 * (radians(low) - radians(o.friction_deg)), "friction_low_stress_deg", low,
          "less: strength would fall with growing pressure");
}

StrengthLaw::StrengthLaw(const MaterialOptions& o, double cell_m)
    : friction_(radians(o.friction_deg)),
      friction_low_(radians(o.friction_low_stress_deg.value_or(o.friction_deg))),
      per_half_(o.friction_half_pa ? 1 / *o.friction_half_pa : 0),
      residual_friction_(radians(o.friction_residual_deg.value_or(o.friction_deg))),
      cohesion_(o.cohesion_pa),
      residual_cohesion_(o.cohesion_residual_pa.value_or(o.cohesion_pa)),
      rate_(o.softening_shape),
      dilatancy_(radians(o.dilatancy_deg)),
      per_fade_(o.dilatancy_fade ? 1 / *o.dilatancy_fade : 0),
      sin_dilatancy_(std::sin(dilatancy_)) {
  if (o.softening_length_m) {
    const double length = *o.softening_length_m;
    if (o.softening_average == SofteningAverage::smeared) {
      require(cell_m > 0, "softening_length_m", length, "cells to be smeared over");
      rate_ *= cell_m / length;
    } else {
      require(length >= cell_m, "softening_length_m", length, "a cell (" + number(cell_m) + " m) or more, for the average");
      nonlocal_length_ = length;
    }
  }
  const bool softens = o.friction_residual_deg || o.cohesion_residual_pa;
  constant_ = !softens && per_half_ == 0 && (per_fade_ == 0 || dilatancy_ == 0);
  initial_ = changed(0, 0);
}

Strength StrengthLaw::changed(double history, double pressure) const {
  Strength s{};
  const double p = std::max(0.0, pressure), per = 1 / (1 + p * per_half_);
  const double peak = friction_ + (friction_low_ - friction_) * per;
  const double left = rate_ > 0 ? std::exp(-rate_ * history) : 1;
  s.friction = residual_friction_ + (peak - residual_friction_) * left;
  s.friction_by_history = -rate_ * (peak - residual_friction_) * left;
  s.friction_by_pressure = pressure > 0 ? -(friction_low_ - friction_) * per_half_ * per * per * left : 0;
  s.sin_friction = std::sin(s.friction);
  s.cos_friction = std::cos(s.friction);
  s.cohesion = residual_cohesion_ + (cohesion_ - residual_cohesion_) * left;
  s.cohesion_by_history = -rate_ * (cohesion_ - residual_cohesion_) * left;
  if (per_fade_ > 0) s.sin_dilatancy = std::sin(std::min(s.friction, dilatancy_ * std::exp(-per_fade_ * history)));
  else s.sin_dilatancy = std::min(s.sin_friction, sin_dilatancy_);
  return s;
}

}  // namespace pivnp::mpm

#include "mpm/material/strength.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

[[noreturn]] void refuse(const std::string& key, const char* name, double found, const std::string& expected) {
  throw InputError(key + "." + name + ": found " + number(found) + ", expected " + expected);
}

}  // namespace

StrengthLaw::StrengthLaw(const MaterialOptions& o, const std::string& key, double cell_m)
    : friction_(radians(o.friction_deg)),
      friction_low_(radians(o.friction_low_stress_deg.value_or(o.friction_deg))),
      per_half_(0),
      residual_friction_(radians(o.friction_residual_deg.value_or(o.friction_deg))),
      cohesion_(o.cohesion_pa),
      residual_cohesion_(o.cohesion_residual_pa.value_or(o.cohesion_pa)),
      rate_(o.softening_shape),
      dilatancy_(radians(o.dilatancy_deg)),
      per_fade_(0),
      sin_dilatancy_(std::sin(dilatancy_)) {
  const bool softens = o.friction_residual_deg || o.cohesion_residual_pa;
  if (!(residual_friction_ >= 0 && residual_friction_ <= friction_))
    refuse(key, "friction_residual_deg", *o.friction_residual_deg, "0 to friction_deg");
  if (!(residual_cohesion_ >= 0 && residual_cohesion_ <= cohesion_))
    refuse(key, "cohesion_residual_pa", *o.cohesion_residual_pa, "0 to cohesion_pa");
  if (softens && !(rate_ > 0 && std::isfinite(rate_)))
    refuse(key, "softening_shape", rate_, "a rate above 0 beside a residual strength");
  if (!softens && rate_ != 0)
    refuse(key, "softening_shape", rate_, "friction_residual_deg or cohesion_residual_pa beside it");
  if (o.softening_length_m) {
    if (!softens) refuse(key, "softening_length_m", *o.softening_length_m, "a residual strength beside it");
    if (!(*o.softening_length_m > 0 && cell_m > 0)) refuse(key, "softening_length_m", *o.softening_length_m, "above 0");
    if (o.softening_average == SofteningAverage::smeared) rate_ *= cell_m / *o.softening_length_m;
  }
  if (o.softening_average == SofteningAverage::nonlocal) {
    if (!o.softening_length_m) throw InputError(key + ".softening_length_m: missing beside softening_average = \"nonlocal\"");
    nonlocal_length_ = *o.softening_length_m;
    if (nonlocal_length_ < cell_m)
      refuse(key, "softening_length_m", nonlocal_length_, "a cell (" + number(cell_m) + " m) or more, for the average");
  }
  if (o.friction_low_stress_deg.has_value() != o.friction_half_pa.has_value())
    throw InputError(key + (o.friction_half_pa ? ".friction_half_pa" : ".friction_low_stress_deg") +
                     ": given alone, expected friction_low_stress_deg and friction_half_pa");
  if (o.friction_half_pa) {
    if (!(*o.friction_half_pa > 0)) refuse(key, "friction_half_pa", *o.friction_half_pa, "above 0 Pa");
    if (!(friction_low_ >= friction_ && friction_low_ <= radians(89)))
      refuse(key, "friction_low_stress_deg", *o.friction_low_stress_deg, "friction_deg to 89");
    // Strength must grow with pressure: tan phi > |d phi / d ln p|, at most (phi_low - phi_high)/4.
    if (!(std::tan(residual_friction_) > 0.25 * (friction_low_ - friction_)))
      refuse(key, "friction_low_stress_deg", *o.friction_low_stress_deg,
             "less: strength would fall with growing pressure");
    per_half_ = 1 / *o.friction_half_pa;
  }
  if (o.dilatancy_fade) {
    if (!(*o.dilatancy_fade > 0)) refuse(key, "dilatancy_fade", *o.dilatancy_fade, "a strain above 0");
    per_fade_ = 1 / *o.dilatancy_fade;
  }
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

// The length of a step.
#pragma once

#include <algorithm>
#include <cmath>

namespace pivnp::mpm {

/// Where mpm.courant is left out.
inline constexpr double least_courant = 0.4, most_courant = 0.8;

/// Of B-splines with APIC, dry: from how stiffly points hang on their own nodes now (own_frequency2()). A lone point, 12 at most,
/// swings by an affine velocity that takes up 4/h of what strains it by 6/h (trace 8 and 12): it is stable up to courant
/// sqrt((1 - nu)/2), of which 0.4 leaves a fifth in hand where nu is 1/2. Fewer than 3, and the cells' common waves decide.
inline double courant_of(double own_frequency2) {
  constexpr double lone = 12;
  return std::clamp(least_courant * std::sqrt(lone / own_frequency2), least_courant, most_courant);
}

/// courant * h / (c_p + |v|): h the smaller cell side, c_p the fastest compression wave sqrt((K + 4G/3)/rho), |v| the
/// fastest point or body. MUSL forms strain from velocities averaged by mass, so that a point close to a cell's edge
/// (small nodal mass) does not shorten it.
inline double stable_step(double courant, double h, double wave_speed, double fastest) {
  return courant * h / (wave_speed + fastest);
}

/// Where pressure is projected: share of the strain by its own change that a pressure foresees. That change then is at most a
/// force of (dt omega)^2 = 1/share, and the skeleton keeps the rest of 4: the step is that of its wave times sqrt(1 - 1/(4 share)).
inline constexpr double foreseen_share = 0.4;
inline double projected_step_share() { return std::sqrt(1 - 1 / (4 * foreseen_share)); }

/// Of the flow alone one over its step t_d, 1/s: 2 D (1/hx^2 + 1/hy^2), D the diffusivity of pressure.
inline double rate_of_flow(double hx, double hy, double diffusivity) {
  return 2 * diffusivity * (1 / (hx * hx) + 1 / (hy * hy));
}

/// With water: courant times what (dt/t_w)^2 + dt/t_d = 1 gives, t_w = h/(c + |v|) with c of the undrained mixture.
/// docs/theory/mpm_water.md#step.
inline double stable_step_with_water(double courant, double hx, double hy, double wave_speed, double fastest, double diffusivity) {
  const double per_wave = (wave_speed + fastest) / std::min(hx, hy), per_flow = rate_of_flow(hx, hy, diffusivity);
  return courant * 2 / (per_flow + std::sqrt(per_flow * per_flow + 4 * per_wave * per_wave));
}

/// Where pressure is explicit: does the flow take parts of a step of the waves? Beside heat, where bands make a step
/// dear and pressure is not projected, if they are twice as long as steps of waves and flow. (Not where bands exchange
/// as printed, once in a step.)
inline bool flow_takes_parts(bool heated, bool printed, double of_waves, double of_both) {
  return heated && !printed && of_waves >= 2 * of_both;
}

/// The step in use: what is left is cut into equal steps no longer than `longest`, so that none is tiny.
inline double trimmed_step(double time, double target, double longest) {
  const double left = target - time;
  return left / std::max(1.0, std::ceil(left / longest * (1 - 1e-12)));
}

}  // namespace pivnp::mpm

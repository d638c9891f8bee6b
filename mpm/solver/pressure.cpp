// How pore pressure is advanced where the case leaves it open (docs/theory/mpm_water.md#projected).
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "mpm/solver/impl.hpp"
#include "mpm/step/time_step.hpp"

namespace pivnp::mpm {

namespace {

constexpr double per_condition = 0.1;  // cost of a projected step: 1.6 and 2.3 explicit ones where 1.6 and 2.4 were measured
constexpr double worth_it = 2;         // times as fast
constexpr double small_strain = 0.1;   // points that lose a third of their volume run dry, since their water is counted beside their pressure

double length(const std::optional<Pair>& v) { return v ? std::hypot((*v)[0], (*v)[1]) : 0; }

}  // namespace

// What speaks against projected pressure: it is refused beside some things, knows no waves in the water, and a load or motion at
// once leaves an energy residual (docs/limits.md). `crossing`: of the skeleton's wave across the domain. Empty: nothing.
std::string Solver::Impl::against_projection(double crossing) const {
  if (has_inertia()) return "water.inertia is given";
  if (water->surface_may_move(p)) return "the water has a surface inside the material";
  if (!scene.water->surface_m.empty() || scene.water->groundwater == Groundwater::level)
    return "the water's surface is given";
  if (!scene.pressure0.empty()) return "pressures are given at the start";
  if (scene.water->start == WaterStart::seepage && scene.water->level_m) return "the start is by seepage with a level";
  if (!scene.contacts.empty() || !scene.bodies.empty() || restraints.tied().any())
    return "there are tied sides, bodies or contact";
  if (scene.heat) return "there is heat";
  if (scheme.shape != ShapeKind::bspline) return "projected steps are bounded with B-splines wherever a surface lies in its cell, and only with them";
  if (std::any_of(pores.begin(), pores.end(), [](const PoreSoil& soil) { return !soil.holds_water(); }))
    return "some of the material holds no water of its own";
  if (restraints.any_absorbing()) return "an absorbing wall asks for waves";
  if (!scene.v0.empty() || scene.body_force) return "the material moves from the start";
  double modulus = std::numeric_limits<double>::max(), heaviest = 0, load = 0;
  for (std::size_t k = 0; k < materials.size(); ++k) {
    if (std::isfinite(loading.removal(k))) return "material is removed at once";
    modulus = std::min(modulus, materials[k]->elastic().p_wave_modulus());
    heaviest = std::max(heaviest, density[k]);
  }
  for (const auto& [name, b] : scene.boundaries) {
    if (length(b.velocity_m_s) > 0) return "boundary." + name + " moves at once";
    if (b.until_s || length(b.withdraw_m_s) > 0) return "boundary." + name + " lets go at once";
    if (b.traction_pa && b.rise_s < crossing) return "the load of boundary." + name + " acts at once";
    load += length(b.traction_pa);
  }
  const bool weighs =
      loading.gravity(0).norm() > 0 || (loading.gravity_changes() && options.gravity_ramp_s.value_or(0) < crossing);
  if (weighs && !options.initial_equilibrium && !options.k0 && scene.stress0.empty()) return "the weight acts at once";
  const Vec2 extent = g.domain.spacing.cwiseProduct(Vec2(g.domain.nx - 1, g.domain.ny - 1));
  if (loading.gravity_changes()) load += heaviest * length(options.gravity_m_s2) * extent.y();
  if (load > small_strain * modulus) return "what is loaded may be compressed by more than a tenth";
  return "";
}

// Projected where it should be at least twice as fast and nothing speaks against it. What a projected step costs over an
// explicit one grows as the iterations of its conjugate gradients do, with the root of the condition of its matrix.
void Solver::Impl::choose_pressure() {
  const PoreWater::Rates rates = water->rates(p);
  const double hx = g.grid.spacing.x(), hy = g.grid.spacing.y(), h = std::min(hx, hy),
               dry = wave_speed(materials, density, p, 1);
  const double undrained = wave_speed(materials, density, p, 1, rates.stiffness);
  const double in_steps = stable_step_with_water(1, hx, hy, undrained, 0, rates.diffusivity);
  const double projected = mpm::stable_step(1, h, dry / projected_step_share(), 0);
  const double stiffest =
      rates.stiffness.empty() ? 0 : *std::max_element(rates.stiffness.begin(), rates.stiffness.end());
  const double condition =
      (foreseen_share * projected * projected * stiffest / least_density() + projected * rates.diffusivity) / (h * h);
  const double longer = projected / in_steps, costlier = 1 + per_condition * std::sqrt(condition),
               gain = longer / costlier;
  const Vec2 extent = g.domain.spacing.cwiseProduct(Vec2(g.domain.nx - 1, g.domain.ny - 1));
  const std::string reason = against_projection(extent.maxCoeff() / dry);
  options.pressure = reason.empty() && gain >= worth_it ? PressureScheme::projected : PressureScheme::in_steps;
  const double of_waves = stable_step_with_water(1, hx, hy, undrained, 0, 0);
  flows_in_parts = options.pressure == PressureScheme::in_steps &&
                   flow_takes_parts(scene.heat.has_value(),
                                    std::any_of(scene.materials.begin(), scene.materials.end(), exchanges_as_printed),
                                    of_waves, in_steps);
  std::ostringstream text;
  text.precision(2);
  text << "Pore pressure is " << name_of(*options.pressure) << ": ";
  if (!reason.empty())
    text << reason;
  else
    text << "projected steps are " << longer << " times as long and should cost " << costlier << " times as much, "
         << (gain >= worth_it ? "and loads are slow" : "which saves too little for what explicit ones are more accurate");
  if (flows_in_parts)
    text << "; steps that the flow would make " << of_waves / in_steps
         << " times as short are those of the waves, in which it takes parts";
  text << " (mpm.pressure).";
  pressure_choice = text.str();
}

}  // namespace pivnp::mpm

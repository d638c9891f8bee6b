// What is not stepped while it rests (sleep.hpp).
#include <algorithm>
#include <cmath>

#include "mpm/solver/impl.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t steps_between_looks = 10;  // steps
constexpr double watched = 2;            // crossings of the material for which a block must have been quiet

}  // namespace

void Solver::Impl::wake_what_moves() {
  if (!sleep.on()) return;
  if (loading.changing_after(state.time) || (water && water->moves_after(state.time))) sleep.wake_all();
  sleep.begin_step(bodies.moving_corners(state.time), g);
}

void Solver::Impl::let_sleep() {
  if (!sleep.on()) return;
  const bool look = state.steps % steps_between_looks == 0;
  state.balance.damping += sleep.fall_asleep(look, state.time, look ? watched * wave_across() : 0, p, g);
}

void Solver::Impl::look_for_rest(double dt) {
  if (!sleep.on()) return;
  sleep.count(dt, g.cells.order.size());
  if ((state.steps + 1) % steps_between_looks != 0) return;
  std::vector<Vec2> flow;
  if (water) flow = water->flow_at_points(p, g, loading.tractions(), loading.gravity(state.time), state.time, choice.threads());
  sleep.look(state.time, push_per_mass(dt), wave_across(), g, reactions, flow);
  if (!water) return;
  const double drained_over = extent().minCoeff();
  const double settles = consolidates > 0 ? 4 * drained_over * drained_over / (M_PI * M_PI * consolidates) : 0;
  sleep.watch_pressure({state.time, watched * wave_across() - 2 * dt, least_density() * wave_of_rest() * *options.sleep_below_m_s, settles}, p, g);
}

void Solver::Impl::start_sleep() {
  if (!water || !sleep.on()) return;
  skeleton_speed = wave_speed(materials, density, p, 1);
  for (std::size_t k = 0; k < pores.size(); ++k) {
    const PoreSoil& soil = pores[k];
    if (!soil.holds_water() || !(soil.mobility > 0)) continue;
    const double storage = 1 / materials[k]->elastic().p_wave_modulus() + soil.porosity / scene.water->bulk_modulus_pa;
    const double diffusivity = soil.mobility / storage;
    consolidates = consolidates > 0 ? std::min(consolidates, diffusivity) : diffusivity;
  }
}

// Waves in the water do not tell what a stress would displace.
double Solver::Impl::wave_of_rest() const { return water && sleep.on() ? skeleton_speed : state.wave_speed; }

// Of the rectangle of cells that holds the material.
Vec2 Solver::Impl::extent() const {
  if (g.cells.size() == 0) return Vec2::Zero();
  const int nx = g.grid.nx;
  int low = nx, high = 0;
  for (const std::int32_t c : g.cells.index) {
    low = std::min(low, c % nx);
    high = std::max(high, c % nx);
  }
  const double width = (high - low + 1) * g.grid.spacing.x();
  const double height = (g.cells.index.back() / nx - g.cells.index.front() / nx + 1) * g.grid.spacing.y();
  return {width, height};
}

// Time of a wave along the longer side of the material.
double Solver::Impl::wave_across() const { return extent().maxCoeff() / wave_of_rest(); }

}  // namespace pivnp::mpm

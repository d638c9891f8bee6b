// What is not stepped while it rests (sleep.hpp).
#include <algorithm>

#include "mpm/step/solver_impl.hpp"

namespace pivnp::mpm {

namespace {

constexpr std::int64_t look_every = 10;  // steps
constexpr double watched = 2;            // crossings of the material for which a block must have been quiet

}  // namespace

void Solver::Impl::wake_what_moves() {
  if (!sleep.on()) return;
  if (loading.changing_after(state.time)) sleep.wake_all();
  sleep.begin_step(bodies.moving_corners(state.time), g);
}

void Solver::Impl::let_sleep() {
  if (!sleep.on()) return;
  const bool look = state.steps % look_every == 0;
  state.balance.damping += sleep.fall_asleep(look, state.time, look ? watched * wave_across() : 0, p, g);
}

void Solver::Impl::look_for_rest(double dt) {
  if (!sleep.on()) return;
  sleep.count(dt, g.cells.order.size());
  if ((state.steps + 1) % look_every == 0)
    sleep.look(state.time, push_per_mass(dt), wave_across(), g, reactions);
}

// Time of a wave along the longer side of the material.
double Solver::Impl::wave_across() const {
  if (g.cells.size() == 0) return 0;
  const int nx = g.grid.nx;
  int low = nx, high = 0;
  for (const std::int32_t c : g.cells.index) {
    low = std::min(low, c % nx);
    high = std::max(high, c % nx);
  }
  const double width = (high - low + 1) * g.grid.spacing.x();
  const double height = (g.cells.index.back() / nx - g.cells.index.front() / nx + 1) * g.grid.spacing.y();
  return std::max(width, height) / state.wave_speed;
}

}  // namespace pivnp::mpm

#include "mpm/step/sleep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/step/energy.hpp"
#include "mpm/transfer/transfer.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

constexpr double body_margin = 6;  // cells around a moving body that stay awake
constexpr double small_mass = 0.2;     // of the lightest point, which gives more than that to one of its nodes at least

double speed(const Node& n, double least) { return n.mass < least ? 0 : std::hypot(n.nx, n.ny); }

// The unbalanced force's stress over the impedance: per_mass is h/c over the step and a full cell's mass.
double push(const Node& n, double per_mass) { return per_mass * n.mass * std::hypot(n.nx - n.vx, n.ny - n.vy); }

}  // namespace

Sleep::Sleep(std::optional<double> below, SleepState& state) : state_(state) {
  if (!below) return;
  if (!(*below > 0) || !std::isfinite(*below))
    throw InputError("mpm.sleep_below_m_s: found " + number(*below) + ", expected a speed above 0 m/s");
  below_ = *below;
}

void Sleep::start(const Particles& p, const GridState& g) {
  if (!on()) return;
  least_ = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < p.size(); ++k) least_ = std::min(least_, small_mass * p.mass_of(k));
  state_.asleep.assign(g.blocks.count(), 0);
  state_.quiet_since.assign(g.blocks.count(), -1.0);
  state_.speed.assign(g.blocks.count(), 0.0);
  state_.foregone.assign(g.blocks.count(), 0.0);
  state_.pressure.assign(p.pressure.empty() ? 0 : p.size(), 0.0);
}

template <class Each>
void Sleep::for_blocks_of_node(const GridState& g, std::uint32_t node, Each&& each) const {
  const int i = int(node) % g.grid.nx, j = int(node) / g.grid.nx, side = SleepingBlocks::side, before = g.width - 1;
  for (int b = std::max(0, j - before) / side; b <= j / side; ++b)
    for (int a = std::max(0, i - before) / side; a <= i / side; ++a) each(std::size_t(b * g.blocks.across() + a));
}

void Sleep::wake(std::size_t block) {
  changed_ = changed_ || state_.asleep[block];
  state_.asleep[block] = 0;
  state_.quiet_since[block] = -1;
}

void Sleep::wake_all() {
  for (std::size_t b = 0; b < state_.asleep.size(); ++b) wake(b);
}

void Sleep::apply(GridState& g) {
  changed_ = false;
  any_ = std::any_of(state_.asleep.begin(), state_.asleep.end(), [](std::uint8_t a) { return a != 0; });
  g.set_asleep(any_ ? state_.asleep : std::vector<std::uint8_t>{});
  sleepers_ = 0;
  for (std::size_t s = 0; any_ && s < g.cells.size(); ++s)
    if (g.blocks.sleeps(g.cells.index[s])) sleepers_ += g.cells.begin[s + 1] - g.cells.begin[s];
}

void Sleep::begin_step(const std::vector<Corners>& moving, GridState& g) {
  for (const auto& [low, high] : moving) {
    const auto cell = [&](double x, double origin, double spacing, int n, double margin) {
      return int(std::clamp((x - origin) / spacing + margin, 0.0, double(n - 1)));
    };
    const Vec2 &o = g.grid.origin, &h = g.grid.spacing;
    const int side = SleepingBlocks::side;
    const int top = cell(high.y(), o.y(), h.y(), g.grid.ny, body_margin) / side;
    const int right = cell(high.x(), o.x(), h.x(), g.grid.nx, body_margin) / side;
    for (int j = cell(low.y(), o.y(), h.y(), g.grid.ny, -body_margin) / side; j <= top; ++j)
      for (int i = cell(low.x(), o.x(), h.x(), g.grid.nx, -body_margin) / side; i <= right; ++i)
        wake(std::size_t(j * g.blocks.across() + i));
  }
  if (changed_) apply(g);
}

double Sleep::fall_asleep(bool look_now, double time, double window, Particles& p, GridState& g) {
  for (const auto& [cell, k] : g.cells.arrivals)
    if (state_.asleep[g.blocks.of_cell(cell)]) wake(g.blocks.of_cell(cell));
  double taken = 0;
  if (look_now) {
    std::vector<std::uint8_t> falls(state_.asleep.size(), 0);
    for (std::size_t b = 0; b < falls.size(); ++b)
      falls[b] = !state_.asleep[b] && state_.quiet_since[b] >= 0 && time - state_.quiet_since[b] >= window;
    for (std::size_t s = 0; s < g.cells.size(); ++s) {
      const std::size_t b = g.blocks.of_cell(g.cells.index[s]);
      if (!falls[b]) continue;
      state_.asleep[b] = 1;
      changed_ = true;
      for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
        const std::uint32_t k = g.cells.order[q];
        taken += stored_kinetic(p, g, k);
        p.vx[k] = p.vy[k] = 0;
        if (!p.C_xx.empty()) p.C_xx[k] = p.C_xy[k] = p.C_yx[k] = p.C_yy[k] = 0;
      }
    }
  }
  if (changed_) apply(g);
  state_.energy += taken;
  return taken;
}

void Sleep::hold(double per_mass, GridState& g) {
  for (const std::uint32_t n : g.active.border)
    if (speed(g.node[n], least_) + push(g.node[n], per_mass) > below_)
      for_blocks_of_node(g, n, [&](std::size_t b) {
        if (state_.asleep[b]) wake(b);
      });
  for (const std::uint32_t n : g.active.resting) {
    g.node[n].nx = g.node[n].ny = 0;
    g.node[n].hold();
  }
}

void Sleep::hold_strain_velocity(GridState& g) const {
  for (const std::uint32_t n : g.active.resting) {
    const GridState::StrainVelocity u = g.strain_velocity(n);
    u.x = u.y = 0;
  }
}

void Sleep::watch_pressure(const PressureWatch& watch, const Particles& p, const GridState& g) {
  std::vector<double> changed(state_.asleep.size(), 0.0);
  const auto for_points = [&](auto&& each) {
    for (std::size_t s = 0; s < g.cells.size(); ++s)
      for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) each(g.blocks.of_cell(g.cells.index[s]), g.cells.order[q]);
  };
  for_points([&](std::size_t b, std::uint32_t k) { changed[b] = std::max(changed[b], std::abs(p.pressure[k] - state_.pressure[p.index[k]])); });
  std::vector<std::uint8_t> anew(state_.asleep.size(), 0);
  for (std::size_t b = 0; b < anew.size(); ++b) {
    if (state_.asleep[b]) {
      if (!(changed[b] <= watch.most)) wake(b);
      continue;
    }
    const double since = watch.time - state_.quiet_since[b];
    anew[b] = state_.quiet_since[b] < 0 || !(since > 0);
    if (anew[b]) continue;
    const double to_come = since >= watch.window ? changed[b] * watch.settles / since : changed[b];
    if (to_come <= watch.most / 2) continue;
    anew[b] = 1;
    state_.quiet_since[b] = watch.time;
    state_.speed[b] = 0;
  }
  for_points([&](std::size_t b, std::uint32_t k) {
    if (anew[b]) state_.pressure[p.index[k]] = p.pressure[k];
  });
}

void Sleep::look(double time, double per_mass, double across, const GridState& g,
                 const std::vector<Reaction>& reactions, std::span<const Vec2> flow) {
  unrest_.assign(state_.asleep.size(), 0.0);
  speed_.assign(state_.asleep.size(), 0.0);
  std::size_t r = 0;
  for (const std::uint32_t n : g.active.nodes) {
    while (r < g.active.resting.size() && g.active.resting[r] < n) ++r;
    if (r < g.active.resting.size() && g.active.resting[r] == n) continue;
    const Node& node = g.node[n];
    const double v = speed(node, least_), u = v + push(node, per_mass);
    for_blocks_of_node(g, n, [&](std::size_t b) {
      unrest_[b] = std::max(unrest_[b], u);
      speed_[b] = std::max(speed_[b], v);
    });
  }
  std::vector<double> flows(flow.empty() ? 0 : unrest_.size(), 0.0);
  for (std::size_t s = 0; !flow.empty() && s < g.cells.size(); ++s)
    for (std::uint32_t q = g.cells.begin[s]; q < g.cells.begin[s + 1]; ++q) {
      double& most = flows[g.blocks.of_cell(g.cells.index[s])];
      most = std::max(most, flow[g.cells.order[q]].norm());
    }
  for (std::size_t b = 0; b < flows.size(); ++b) {
    unrest_[b] += flows[b];
    speed_[b] += flows[b];
  }
  for (const Reaction& reaction : reactions)
    if (reaction.body < 0 && (reaction.wall_x != 0 || reaction.wall_y != 0))
      for_blocks_of_node(g, reaction.node,
                         [&](std::size_t b) { unrest_[b] = std::numeric_limits<double>::infinity(); });
  for (std::size_t b = 0; b < unrest_.size(); ++b) {
    if (state_.asleep[b]) continue;
    const bool quiet = unrest_[b] <= 0.5 * below_;  // false for NaN
    if (!quiet || state_.quiet_since[b] < 0) {
      state_.quiet_since[b] = quiet ? time : -1;
      state_.speed[b] = 0;
    }
    state_.speed[b] = std::max(state_.speed[b], speed_[b]);
  }
  if (any_) state_.held_back = std::max(state_.held_back, below_ * across);
}

void Sleep::count(double dt, std::size_t points) {
  state_.all += double(points);
  if (!any_) return;
  state_.skipped += double(sleepers_);
  for (std::size_t b = 0; b < state_.asleep.size(); ++b)
    if (state_.asleep[b]) state_.foregone[b] += state_.speed[b] * dt;
}

void Sleep::resume(GridState& g) {
  if (!on()) return;
  apply(g);
}

}  // namespace pivnp::mpm

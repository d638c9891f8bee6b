// The velocity that strains the material: nodes that have one of their own, and its value at any place.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

void GridState::strain_apart(std::uint32_t n, int count) {
  if (!by_updated) return;
  const int before = width - 1, i = int(n) % grid.nx, j = int(n) / grid.nx, last = i + count - 1;
  const int from = std::max(0, i - before), to = std::min(grid.nx - 1, last + before);
  for (int b = std::max(0, j - before); b <= std::min(grid.ny - 1, j + before); ++b) {
    for (int a = from; a <= to; ++a) {
      const std::size_t m = grid.node(a, b);
      if (node[m].apart) continue;
      node[m].apart = true;
      straining_[m] = {node[m].nx, node[m].ny};
      apart_nodes_.push_back(std::uint32_t(m));
    }
    if (b > j) continue;
    const auto end = std::int32_t(grid.node(last, b));
    for (std::size_t s = first_slot_from(std::int32_t(grid.node(from, b))); s < slots() && slot_cell[s] <= end; ++s) {
      if (slot_marks[s] & strained_apart) continue;
      slot_marks[s] |= strained_apart;
      apart_slots_.push_back(std::uint32_t(s));
    }
  }
}

void GridState::strain_together() {
  for (const std::uint32_t n : apart_nodes_) {
    node[n].apart = false;
    straining_[n] = {};
  }
  for (const std::uint32_t s : apart_slots_) slot_marks[s] &= std::uint8_t(~strained_apart);
  apart_nodes_.clear();
  apart_slots_.clear();
}

// `distance`: squared, from the nearest occupied cell.
std::int32_t GridState::slot_near(const Vec2& x, int on_sheet, double& xi, double& eta, double& distance) const {
  std::int32_t cell = 0;
  distance = 0;
  if (!find(x.x(), x.y(), cell, xi, eta, on_sheet)) return -1;
  const std::int32_t own = slot_of(cell);
  if (own >= 0) return own;
  const int first = on_sheet * sheet_rows, i0 = int(cell % grid.nx), j0 = int(cell / grid.nx);
  const double x0 = xi, y0 = eta, low = width == 2 ? 0.0 : -0.5;
  distance = std::numeric_limits<double>::infinity();
  std::int32_t best = -1;
  constexpr int reach = 2;  // cells
  for (int j = std::max(first, j0 - reach); j <= std::min(first + sheet.ny - width, j0 + reach); ++j)
    for (int i = std::max(0, i0 - reach); i <= std::min(grid.nx - width, i0 + reach); ++i) {
      const std::int32_t s = slot_of(std::int32_t(grid.node(i, j)));
      if (s < 0) continue;
      const double here_x = x0 - (i - i0), here_y = y0 - (j - j0);  // from that cell
      const double in_x = std::clamp(here_x, low, low + 1), in_y = std::clamp(here_y, low, low + 1);
      const double away = std::pow((here_x - in_x) * grid.spacing.x(), 2) +
                          std::pow((here_y - in_y) * grid.spacing.y(), 2);
      if (away >= distance) continue;
      distance = away;
      best = s;
      xi = in_x;
      eta = in_y;
    }
  return best;
}

void GridState::weights_at(std::int32_t cell, double xi, double eta, std::size_t* at, double* weights) const {
  const unsigned f = fold_of(cell);
  with_shape(shape, [&](auto kind) {
    using S = decltype(kind);
    constexpr double half = 0.25;
    const auto lx = S::line(xi, half, f & fold_left, f & fold_right), ly = S::line(eta, half, f & fold_down, f & fold_up);
    for (int c = 0; c < S::width * S::width; ++c) {
      at[c] = std::size_t(cell + c / S::width * grid.nx + c % S::width);
      weights[c] = lx.w[c % S::width] * ly.w[c / S::width];
    }
  });
}

// Of several fields the one whose material is nearest; where they are equally near, the one with more mass.
Vec2 GridState::velocity_at(const Vec2& x) const {
  Vec2 v = Vec2::Zero();
  double nearest = std::numeric_limits<double>::infinity(), heaviest = 0;
  for (int k = 0; k < sheets; ++k) {
    double xi = 0, eta = 0, distance = 0;
    const std::int32_t s = slot_near(x, k, xi, eta, distance);
    if (s < 0 || distance > nearest) continue;
    std::size_t at[9];
    double w[9], mass = 0;
    weights_at(slot_cell[std::size_t(s)], xi, eta, at, w);
    Vec2 here = Vec2::Zero();
    for (int c = 0; c < stencil; ++c) {
      here += w[c] * straining(at[c]);
      mass += w[c] * node[at[c]].mass;
    }
    if (distance == nearest && mass <= heaviest) continue;
    nearest = distance;
    heaviest = mass;
    v = here;
  }
  return v;
}

}  // namespace pivnp::mpm

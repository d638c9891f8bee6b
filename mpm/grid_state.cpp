#include "mpm/grid_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/core/grid/shape.hpp"

namespace pivnp::mpm {

GridState::GridState(const Grid& g)
    : grid(g),
      per_hx(1 / g.spacing.x()),
      per_hy(1 / g.spacing.y()),
      node(g.node_count()),
      slot_of_cell_(g.element_count(), -1),
      count_(g.element_count(), 0) {}

void GridState::rebuild(const Particles& p) {
  std::int32_t first = std::numeric_limits<std::int32_t>::max(), last = -1;
  for (const std::int32_t c : p.cell)
    if (c != Particles::ended) {
      first = std::min(first, c);
      last = std::max(last, c);
      ++count_[std::size_t(c)];
    }
  std::vector<std::int32_t> cells;
  cells.reserve(slot_cell.size() + 16);
  slot_begin.clear();
  std::uint32_t begin = 0;
  for (std::int32_t c = first; c <= last; ++c)
    if (count_[std::size_t(c)] > 0) {
      cells.push_back(c);
      slot_begin.push_back(begin);
      begin += count_[std::size_t(c)];
      count_[std::size_t(c)] = slot_begin.back();  // from here on: where the cell's next point goes
    }
  slot_begin.push_back(begin);
  order.resize(begin);
  for (std::uint32_t k = 0; k < p.cell.size(); ++k)
    if (p.cell[k] != Particles::ended) order[count_[std::size_t(p.cell[k])]++] = k;
  for (const std::int32_t c : cells) count_[std::size_t(c)] = 0;

  if (cells == slot_cell) return;
  for (const std::int32_t c : slot_cell) slot_of_cell_[std::size_t(c)] = -1;
  slot_cell.swap(cells);
  for (std::size_t s = 0; s < slot_cell.size(); ++s) slot_of_cell_[std::size_t(slot_cell[s])] = std::int32_t(s);
  sums.resize(slots() + 1);
  sums.back() = CellSums{};
  rebuild_nodes();
}

void GridState::rebuild_nodes() {
  for (const std::uint32_t n : nodes) node[n] = Node{};
  nodes.clear();
  const auto nx = std::uint32_t(grid.nx);
  for (std::size_t s = 0; s < slots(); ++s) {
    const auto n = std::uint32_t(corner(s));
    nodes.insert(nodes.end(), {n, n + 1, n + nx, n + nx + 1});
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());

  const auto empty = std::uint32_t(slots());
  const auto slot_at = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= grid.nx - 1 || j >= grid.ny - 1) return empty;
    const std::int32_t s = slot_of_cell_[grid.element(i, j)];
    return s < 0 ? empty : std::uint32_t(s);
  };
  node_slots.resize(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const int i = int(nodes[k] % nx), j = int(nodes[k] / nx);
    node_slots[k] = {slot_at(i, j), slot_at(i - 1, j), slot_at(i, j - 1), slot_at(i - 1, j - 1)};
  }
}

bool GridState::nearest_with_material(const Vec2& x, ElementPoint& at) const {
  const auto active = [&](int i, int j) { return slot_of_cell_[grid.element(i, j)] >= 0; };
  if (active(at.i, at.j)) return true;
  double least = std::numeric_limits<double>::infinity();
  const ElementPoint home = at;
  constexpr int reach = 2;  // cells
  for (int j = std::max(0, home.j - reach); j <= std::min(grid.ny - 2, home.j + reach); ++j)
    for (int i = std::max(0, home.i - reach); i <= std::min(grid.nx - 2, home.i + reach); ++i) {
      if (!active(i, j)) continue;
      const Vec2 lower = grid.position(i, j);
      const Vec2 inside = x.cwiseMax(lower).cwiseMin(lower + grid.spacing);
      const double distance = (x - inside).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      const Vec2 natural = (inside - lower).cwiseQuotient(grid.spacing);
      at = {i, j, natural.x(), natural.y()};
    }
  return std::isfinite(least);
}

Vec2 GridState::velocity_at(const Vec2& x) const {
  ElementPoint at;
  if (!locate(grid, x, at) || !nearest_with_material(x, at)) return Vec2::Zero();
  const BilinearWeights w = bilinear(grid, at);
  const auto corners = bilinear_nodes(grid, at);
  Vec2 v = Vec2::Zero();
  for (std::size_t c = 0; c < 4; ++c) v += w.value[c] * Vec2(node[corners[c]].ux, node[corners[c]].uy);
  return v;
}

}  // namespace pivnp::mpm

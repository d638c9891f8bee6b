#include "mpm/grid/grid_state.hpp"

#include <algorithm>

namespace pivnp::mpm {

GridState::GridState(const Grid& d, ShapeKind kind, int n_fields, bool updated, const NodeNeeds& needs, bool about_axis)
    : GridGeometry(d, kind, n_fields, about_axis),
      by_updated(updated),
      cells(grid),
      blocks(grid),
      node(grid.node_count()) {
  arrays.allocate(grid.node_count() + 3 * std::size_t(grid.nx) + 24, needs);
}

AverageArrays GridState::averages() {
  if (arrays.edges.size() == 0) return {};
  const std::size_t first = std::size_t(grid.nx) + 1;
  return {arrays.edges.data() + first, arrays.corners.data() + first, arrays.shift.data() + first, arrays.fluxes.data() + first,
          grid.nx};
}

void GridState::rebuild(const Particles& p) {
  relocation.done = false;
  join_strain_velocities();
  if (!cells.rebuild(p)) return;
  mark_cells();
  list_active();
}

void GridState::follow(const Particles& p, const std::vector<Move>& moves) {
  join_strain_velocities();
  if (!cells.follow(p, moves)) return;
  mark_cells();
  list_active();
}

void GridState::set_walls(std::vector<std::uint8_t> of_nodes, std::vector<std::uint8_t> with_ties,
                          std::vector<Vec2> shifts) {
  walls = std::move(of_nodes);
  sides = std::move(with_ties);
  shift = std::move(shifts);
  move_nodes();
  mark_cells();
}

// What a moved node is to its own cell, and to the next one inwards.
void GridState::move_nodes() {
  moved.assign(shift.empty() ? 0 : grid.node_count(), {});
  const std::size_t before = std::size_t(grid.nx) + 1, step[] = {1, std::size_t(grid.nx)};
  for (std::size_t n = before; n < shift.size(); ++n)
    for (int axis = 0; axis < 2; ++axis) {
      const double s = shift[n][axis] / grid.spacing[axis];
      const std::uint8_t low = axis == 0 ? wall_left : wall_down, high = axis == 0 ? wall_right : wall_up;
      const std::size_t cell = n - before;
      if (s != 0 && walls[n] & low) {
        moved[cell].low[axis] = s;
        if (!(walls[n + step[axis]] & low)) moved[cell + step[axis]].low[axis] = s;
      } else if (s != 0 && walls[n] & high) {
        moved[cell].high[axis] = -s;
        if (!(walls[n - step[axis]] & high) && cell >= step[axis]) moved[cell - step[axis]].high[axis] = -s;
      }
    }
}

void GridState::set_asleep(const std::vector<std::uint8_t>& asleep) {
  blocks.set(asleep);
  list_active();
}

// (Cells are strained by their nodes' own velocities no more.)
void GridState::mark_cells() {
  marks.resize(cells.size());
  int row = -1;
  std::int32_t row_end = 0;
  for (std::size_t s = 0; s < cells.size(); ++s) {
    for (; cells.index[s] >= row_end; row_end += grid.nx) ++row;
    marks[s] = marks_of(cells.index[s], row);
  }
}

void GridState::list_active() {
  active.rebuild(cells, *this, blocks);
  for (const std::uint32_t n : active.left) {
    if (has_own_strain_velocity(n)) arrays.own_strain_velocity[n] = {};
    node[n] = Node{};
    if (averaged) averages().forget(n);
  }
}

void GridState::separate_strain_velocities(std::uint32_t n, int count) {
  if (!by_updated) return;
  const int before = width - 1, i = int(n) % grid.nx, j = int(n) / grid.nx, last = i + count - 1;
  const int from = std::max(0, i - before), to = std::min(grid.nx - 1, last + before);
  for (int b = std::max(0, j - before); b <= std::min(grid.ny - 1, j + before); ++b) {
    for (int a = from; a <= to; ++a) {
      const std::size_t m = grid.node(a, b);
      if (node[m].apart) continue;
      node[m].apart = true;
      arrays.own_strain_velocity[m] = {node[m].nx, node[m].ny};
      nodes_apart_.push_back(std::uint32_t(m));
    }
    if (b > j) continue;
    const auto end = std::int32_t(grid.node(last, b));
    for (std::size_t s = cells.first_from(std::int32_t(grid.node(from, b))); s < cells.size() && cells.index[s] <= end; ++s) {
      if (marks[s] & strained_apart) continue;
      marks[s] |= strained_apart;
      cells_apart_.push_back(std::uint32_t(s));
    }
  }
}

void GridState::join_strain_velocities() {
  for (const std::uint32_t n : nodes_apart_) {
    node[n].apart = false;
    arrays.own_strain_velocity[n] = {};
  }
  for (const std::uint32_t s : cells_apart_) marks[s] &= std::uint8_t(~strained_apart);
  nodes_apart_.clear();
  cells_apart_.clear();
}

CellView GridState::view() {
  const bool shared = by_updated;
  return {.order = cells.order.data(),
          .begin = cells.begin.data(),
          .index = cells.index.data(),
          .marks = marks.data(),
          .moved = moved.data(),
          .points = cells.order.size(),
          .node = node.data(),
          .strain_velocity = shared ? &node.data()->nx : &arrays.own_strain_velocity.data()->x,
          .to_next = std::ptrdiff_t((shared ? sizeof(Node) : sizeof(NodeVelocity)) / sizeof(double)),
          .own_strain_velocity = &arrays.own_strain_velocity.data()->x,
          .average = averages().view(),
          .nx = grid.nx,
          .ny = field_grid.ny,
          .field_rows = field_rows,
          .origin = origin,
          .hx = grid.spacing.x(),
          .hy = grid.spacing.y(),
          .per_hx = per_hx,
          .per_hy = per_hy,
          .origin_x = grid.origin.x(),
          .origin_y = grid.origin.y()};
}

}  // namespace pivnp::mpm

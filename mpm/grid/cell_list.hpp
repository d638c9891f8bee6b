// The occupied cells of a grid and the points in each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "mpm/state/particles.hpp"
#include "mpm/state/views.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// A point that has another cell now: its place in CellList::order, and the cell it left.
struct Move {
  std::uint32_t place;
  std::int32_t from;
};

/// Occupied cells in the order of their index, that of their lower left node. Only they cost anything.
class CellList {
 public:
  explicit CellList(const Grid& grid);

  std::vector<std::uint32_t> order;  // points, cell after cell
  std::vector<std::int32_t> index;   // of each occupied cell
  std::vector<std::uint32_t> begin;  // its points in `order`; one more at the end

  std::size_t size() const { return index.size(); }
  /// The first occupied cell whose index is this one or a later one.
  std::size_t first_from(std::int32_t cell) const;
  /// Its place among the occupied ones; -1: it is empty.
  std::int32_t find(std::int32_t cell) const;
  /// The points of a cell: places in `order`.
  Range points_in(std::int32_t cell) const;

  /// From Particles::cell. True if other cells are occupied than before.
  bool rebuild(const Particles& particles);
  /// The same, where only these points (their places ascending) have another cell than before.
  bool follow(const Particles& particles, const std::vector<Move>& moves);
  /// Of the last follow(): cells, and the points now in them.
  std::vector<std::pair<std::int32_t, std::uint32_t>> arrivals;

 private:
  void index_rows();

  int nx_, ny_;
  std::vector<std::uint32_t> row_begin_;  // first occupied cell of each row of cells, and the end
  // Of follow().
  std::vector<std::uint32_t> next_order_, next_begin_;
  std::vector<std::int32_t> next_index_;
};

}  // namespace pivnp::mpm

// Which cells hold which points, and what the nodes carry during a step.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "mpm/grid/averages.hpp"
#include "mpm/grid/cell_bits.hpp"
#include "mpm/state/views.hpp"
#include "mpm/state/node.hpp"
#include "mpm/state/particles.hpp"
#include "mpm/grid/shape.hpp"
#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// A band of cells: its runs of slots (places in Bands::runs), and of the nodes in its rows (places in GridState::nodes)
/// those to which no band has added before it, and those to which none will add after it.
struct Band {
  SlotRange runs, fresh, finished;
  std::size_t middle;  // its middle slot, counted over all bands
};

/// Runs of slots, band by band; the parity of a band tells when it adds to its nodes.
struct Bands {
  std::vector<SlotRange> runs;      // of the even bands, then of the odd ones
  std::vector<Band> parity[2];

  std::size_t slots = 0;            // of all

  std::size_t count() const { return parity[0].size() + parity[1].size(); }
  /// Which of so many threads does a band.
  int owner(const Band& band, int threads) const { return int(band.middle * std::size_t(threads) / slots); }
};

/// A "cell" is the set of points that share their nodes: an element for bilinear shapes, the square around a node for
/// uGIMP and B-splines (shape.hpp); it goes by its lower left node. Occupied cells have slots, in the order of their
/// index. Cells add to their nodes band by band, four rows of cells a band: first every other band, then those between
/// them, so that no two threads meet at a node, and each node is added to in a fixed order: the bits do not depend on
/// the number of threads. Only occupied cells cost anything.
///
/// Blocks of cells may sleep (sleep.hpp): their points keep their places, stresses and stillness. Those whose nodes the
/// others' see, the rim, are still mapped to them; the rest is not looked at.
///
/// Bodies in contact have a velocity field each (contact.hpp): a sheet of nodes of its own over the whole domain. The
/// sheets lie one above the other in `grid`, `sheet_rows` rows apart, and a point's cell says to which it belongs; so
/// what is done cell by cell and node by node knows nothing of them. Without contact there is one.
class GridState {
 public:
  /// Points live in `domain`. Shapes of three nodes an axis need a ring of nodes around it, which `sheet` has.
  /// `by_updated`: the updated velocity Node::n strains the material, not one of its own.
  GridState(const Grid& domain, ShapeKind shape, int sheets = 1, bool by_updated = false);

  const ShapeKind shape;
  const int width;    // nodes an axis of a stencil
  const int stencil;  // width^2
  const Grid domain, sheet;  // sheet: with the ring
  const int sheets, sheet_rows;
  const Grid grid;  // all sheets; only the first one's nodes are where this says (position())
  const double per_hx, per_hy;
  const bool by_updated;

  std::vector<std::uint32_t> order;       // points, cell after cell
  std::vector<std::int32_t> slot_cell;    // cell of a slot
  std::vector<std::uint32_t> slot_begin;  // its points in `order`; one more at the end
  std::vector<std::uint8_t> slot_marks;   // walls at the slot's middle node (Fold), strained_apart, at_edge
  Bands awake, mapped;                    // slots that are stepped; those and the rim of what sleeps
  std::vector<SlotRange> pieces;          // the awake slots in short runs, for what does not add to nodes
  std::vector<std::uint32_t> nodes;       // active nodes (of mapped cells), in the order of their index
  std::vector<std::uint32_t> resting;     // those among them that belong to a sleeping cell
  std::vector<std::uint32_t> border;      // and those of these that belong to an awake one too
  Nodes node;                             // of the whole grid; zero where not active
  Averages averages;                      // of three-node shapes
  std::vector<std::uint8_t> fold;         // of every node of the grid
  std::vector<std::pair<std::int32_t, std::uint32_t>> arrivals;  // of follow(): the cells, and the points now in them
  /// A point that has another cell now: its place in `order`, and the cell it left.
  struct Move {
    std::uint32_t place;
    std::int32_t from;
  };
  std::vector<Move> moved;             // of locate_points()
  std::vector<std::uint32_t> scratch;  // of follow(), one a point; in between `suspects` are ranges of it, where `located`:
  std::vector<SlotRange> suspects;     // places in `order` of the points that are not in their cell any more
  bool located = false;

  static constexpr int block_side = 8;  // cells
  int blocks_x() const { return (grid.nx + block_side - 1) / block_side; }
  std::size_t blocks() const { return std::size_t(blocks_x()) * std::size_t((grid.ny + block_side - 1) / block_side); }
  std::size_t block_of(std::int32_t cell) const {
    return std::size_t(cell / grid.nx / block_side * blocks_x() + cell % grid.nx / block_side);
  }
  bool sleeps(std::int32_t cell) const { return !asleep_.empty() && asleep_[block_of(cell)]; }
  /// Which blocks sleep from here on; empty: none.
  void set_asleep(const std::vector<std::uint8_t>& blocks);

  std::size_t slots() const { return slot_cell.size(); }
  /// Flat indices of a slot's nodes, row after row.
  void stencil_nodes(std::size_t slot, std::size_t* out) const;

  std::size_t sheet_nodes() const { return std::size_t(sheet_rows) * std::size_t(grid.nx); }
  /// Where a node is.
  Vec2 position(std::size_t n) const {
    n %= sheet_nodes();
    return sheet.position(int(n % std::size_t(grid.nx)), int(n / std::size_t(grid.nx)));
  }
  /// The cell of a point and its natural coordinates; false outside the domain (round-off of 1e-9 spacings is inside).
  bool find(double x, double y, std::int32_t& cell, double& xi, double& eta, int on_sheet = 0) const;
  /// The points of a cell: places in `order`.
  SlotRange points_in(std::int32_t cell) const {
    const std::int32_t s = slot_of(cell);
    return s < 0 ? SlotRange{} : SlotRange{slot_begin[std::size_t(s)], slot_begin[std::size_t(s) + 1]};
  }
  /// Natural coordinates of a point in its cell.
  Vec2 natural(const Particles& p, std::size_t k) const;
  /// Nodes and weights of a place found there, with the walls' folds (a point of uGIMP as seeded four an element).
  void weights_at(std::int32_t cell, double xi, double eta, std::size_t* at, double* weights) const;
  /// Builds order, slots and active nodes from Particles::cell.
  void rebuild(const Particles& particles);
  /// The same, where only these points (their places ascending) have another cell than before.
  void follow(const Particles& particles, const std::vector<Move>& moves);
  /// Walls of the nodes from here on (Restraints::folds).
  void set_folds(const std::vector<std::uint8_t>& folds);
  /// Of a node, the velocity that strains the material.
  struct Straining {
    double &x, &y;
  };
  Straining straining(std::size_t n) {
    return strains_apart(n) ? Straining{straining_[n].x, straining_[n].y} : Straining{node[n].nx, node[n].ny};
  }
  Vec2 straining(std::size_t n) const {
    return strains_apart(n) ? Vec2(straining_[n].x, straining_[n].y) : Vec2(node[n].nx, node[n].ny);
  }
  bool strains_apart(std::size_t n) const { return !by_updated || node[n].apart; }
  /// `by_updated`: until strain_together() the slots that see this node (or `count` in a row) are strained by velocities
  /// that their nodes have of their own, which are the updated ones as yet.
  void strain_apart(std::uint32_t node, int count = 1);
  void strain_together();
  /// As the kernels see it.
  CellView view();
  /// The straining velocity at a point; beyond occupied cells that of the nearest, two cells away at most, else zero.
  Vec2 velocity_at(const Vec2& x) const;

 private:
  void take_cells();
  void rebuild_lists();
  void rebuild_pieces();
  void rebuild_nodes(const CellBits& cells);
  template <class Keep>
  Bands bands_of(Keep&& keep) const;
  void share_nodes(Bands& bands) const;
  std::int32_t slot_near(const Vec2& x, int on_sheet, double& xi, double& eta, double& distance) const;
  std::uint8_t fold_of(std::int32_t cell) const;
  std::uint8_t marks_of(std::int32_t cell, int row) const;
  std::size_t first_slot_from(std::int32_t cell) const;  // whose cell is this one or a later one
  std::int32_t slot_of(std::int32_t cell) const;         // -1: empty

  OfGrid<NodeVelocity> straining_;          // takes no memory where it is not used
  std::vector<std::uint32_t> apart_slots_, apart_nodes_;
  std::vector<std::uint32_t> row_begin_;    // first slot of each row of cells, and the end
  // Of follow() and rebuild_nodes().
  std::vector<std::uint32_t> next_begin_;
  std::vector<std::int32_t> next_cell_;
  std::vector<std::uint32_t> nodes_before_;
  std::vector<std::uint8_t> asleep_;                              // of each block; empty: none
};

}  // namespace pivnp::mpm

// Which occupied cells and nodes take part in a step, and in what order they are swept over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/grid/cell_bits.hpp"
#include "mpm/grid/cell_list.hpp"
#include "mpm/grid/grid_geometry.hpp"
#include "mpm/grid/sleeping_blocks.hpp"

namespace pivnp::mpm {

/// A band of cells: its runs of occupied cells (places in Bands::runs), and of the nodes in its rows (places in
/// ActiveCells::nodes) those to which no band has added before it, and those to which none will add after it.
struct Band {
  Range runs, fresh, finished;
  std::size_t middle;  // its middle cell, counted over all bands
};

/// Runs of occupied cells, band by band; the parity of a band tells when it adds to its nodes.
struct Bands {
  std::vector<Range> runs;      // of the even bands, then of the odd ones
  std::vector<Band> parity[2];

  std::size_t cells = 0;        // of all

  std::size_t count() const { return parity[0].size() + parity[1].size(); }
  /// Which of so many threads does a band.
  int owner(const Band& band, int threads) const { return int(band.middle * std::size_t(threads) / cells); }
};

/// Cells add to their nodes band by band, four rows of cells a band: first every other band, then those between them, so
/// that no two threads meet at a node, and each node is added to in a fixed order: the bits do not depend on the number of
/// threads.
class ActiveCells {
 public:
  Bands awake, mapped;                 // cells that are stepped; those and the rim of what sleeps
  std::vector<Range> pieces;           // the awake cells in short runs, for what does not add to nodes
  std::vector<Range> flowing;          // likewise with the rim
  std::vector<std::uint32_t> nodes;    // active nodes (of mapped cells), in the order of their index
  std::vector<std::uint32_t> resting;  // those among them that belong to a sleeping cell
  std::vector<std::uint32_t> border;   // and those of these that belong to an awake one too
  std::vector<std::uint32_t> partial;  // and those that belong to a sleeping cell beyond the rim too
  std::vector<std::uint32_t> left;     // nodes that were active before the last rebuild() and are not any more

  void rebuild(const CellList& cells, const GridGeometry& geometry, const SleepingBlocks& blocks);

 private:
  void list_nodes(const CellBits& cells, int width);

  std::vector<std::uint32_t> nodes_before_;
};

}  // namespace pivnp::mpm

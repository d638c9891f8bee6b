// The places where windows are put: the caller's nodes, and the even lattices that the passes before them use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pivnp::piv {

/// Pixels x0 <= column < x1, y0 <= row < y1.
struct Box {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
};

/// Evenly spaced points of the image; point (i, j) at (x0 + i dx, y0 + j dy), row downward.
struct EvenLattice {
  int nx = 0, ny = 0;
  float x0 = 0, y0 = 0, dx = 1, dy = 1;
};

/// Where the nodes are in the image: (column, row) of node (i, j), [ny][nx], j upward in the world. Columns and rows
/// vary smoothly with i and j (square-on: evenly). A node may be switched off (`on` = 0: no material there).
struct NodeLattice {
  int nx = 0, ny = 0;
  std::vector<std::array<float, 2>> pixel;
  std::vector<std::uint8_t> on;  // empty: all on
};

/// True if node k takes part (switched on).
bool switched_on(const NodeLattice& nodes, std::size_t k);

/// Bounding box of the nodes that are on, grown by `margin` pixels and cut at the image; empty if none is inside.
Box bounding_box(const NodeLattice& nodes, float margin, int width, int height);

/// Mean distance in pixels of neighbouring nodes along i or along j, whichever is smaller; 0 for a single node.
float node_spacing(const NodeLattice& nodes);

/// Points about `spacing` apart that divide the box evenly, half a step from its sides.
EvenLattice even_lattice(const Box& box, float spacing);

/// The even lattice as nodes; on are those within `reach` pixels, in column and row, of a node that is on.
NodeLattice nodes_near(const EvenLattice& lattice, const NodeLattice& nodes, float reach);

}  // namespace pivnp::piv

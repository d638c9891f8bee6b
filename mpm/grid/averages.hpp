// The averages of F-bar with three-node shapes: at the corners of the cells, the squares around the nodes, inside
// which the splines are smooth.
//
// A = H L^-1 H^T V, the mean over each corner's hat H of what the points carry, with weights V = V0, interpolated by
// the hats (L = sum V H), keeps constants. Of a linear field it takes the value at the centre c of the corner's points,
// not at the corner x: at a free surface a third of a cell and more inside. Q = H L^-1 (L + C) L^-1 H^T V moves it
// there. A point between two corners moves them apart by V s (1 - s) times the hat across, s its place between them: in
// sum L (x - c). Each cell takes a share F (four corners, two axes) of the sums k of its edges, k k'/(k' + k"), k' that
// of the edge across it and k" that of the edge across its neighbour, which changes continuously where points cross
// cells. With S = F^T c,
//   C = sum over cells of F S^-1 F^T,
// so that C 1 = 0 and C c = sum F = L (x - c): Q keeps constants and linear fields wherever the points lie, and the sum
// of V Q a is that of V a. Q^* = V^-1 Q^T V has S^-T in the place of S^-1. The force uses Q, the strain Q^*: they are
// conjugate. Weighted by V neither is greater than 1, but for some thousandths where points are few and scattered;
// there (least eigenvalue of S below a twentieth of what it is inside) S is raised, and linear fields are kept nearly.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mpm/state/node.hpp"

namespace pivnp::mpm {

enum class Averaging { of_stress, of_strain };  // Q and Q^*

/// A cell and its lower left corner go by the cell's lower left node. Lengths in cells. Zero where no node is active.
struct AverageArrays {
  CellEdges* edges;
  CornerSums* corners;
  AlongAxes* shift;   // of the corner: from its points' centre to it
  AlongAxes* fluxes;  // first the sums of the corner's edges to the right and up, of both cells beside them; then S^-1 F^T
                      // of the corners' means
  std::ptrdiff_t row;  // from a cell to the one above

  /// What the kernels add to and read.
  AverageView view() const { return {edges, corners}; }
  /// This node is active no more.
  void forget(std::uint32_t node) const {
    edges[node] = {};
    corners[node] = {};
    shift[node] = {};
    fluxes[node] = {};
  }
};

/// For nodes of the list whose sums, and those of their cells, are complete: CornerSums::volume becomes 1/L (0 for
/// none); shifts, and the edges' sums of both cells.
void take_edges(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size);
/// Where those are there for all nodes: the cells' shares.
void take_shares(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size);
/// Where these are there for all nodes: the fluxes; then the means, which want the fluxes of the nodes before them in the
/// list and their own, and take the places of the sums: fluxes of nodes behind them do not mind.
void take_fluxes(const AverageArrays& a, Averaging which, const std::uint32_t* nodes, std::size_t size);
void take_means(const AverageArrays& a, const std::uint32_t* nodes, std::size_t size);

}  // namespace pivnp::mpm

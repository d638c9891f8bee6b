// The averages of F-bar with three-node shapes: at the corners of the cells, the squares around the nodes, inside which
// the splines are smooth.
//
// A = H L^-1 H^T V, the mean over each corner's hat H of what the points carry, with weights V = V0, interpolated by the
// hats (L = sum V H), keeps constants. Of a linear field it takes the value at the centre c of the corner's points, not
// at the corner x: at a free surface a third of a cell and more inside. Q = H L^-1 (L + C) L^-1 H^T V moves it there. A
// point between two corners moves them apart by V s (1 - s) times the hat across, s its place between them: in sum
// L (x - c). Each cell takes a share F (four corners, two axes) of the sums k of its edges, k k'/(k' + k"), k' that of its
// edge across and k" that of the neighbour's, which changes continuously where points cross cells. With S = F^T c,
//   C = sum over cells of F S^-1 F^T,
// so that C 1 = 0 and C c = sum F = L (x - c): Q keeps constants and linear fields wherever the points lie, and the sum of
// V Q a is that of V a. Q^* = V^-1 Q^T V has S^-T in the place of S^-1. The force uses Q, the strain Q^*: they are
// conjugate. Weighted by V neither is greater than 1, but for some thousandths where points are few and scattered.
#pragma once

#include "mpm/grid_state.hpp"

namespace pivnp::mpm {

enum class Averaging { of_stress, of_strain };  // Q and Q^*

/// From the sums over each corner's points, V H a in Node::dx and V H in dy (of the node to the lower left), and the
/// sums of the cells' edges: Node::dx becomes what Q or Q^* gives the corner. First for nodes whose sums and whose
/// neighbours' edges are complete (places in GridState::nodes), then for all.
void take_means(GridState& g, SlotRange nodes);
void move_means_to_corners(GridState& g, Averaging which, int threads);

}  // namespace pivnp::mpm

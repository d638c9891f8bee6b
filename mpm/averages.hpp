// The averages of F-bar with three-node shapes.
//
// A = H L^-1 H^T V, the mean over each node's hat H of what the points carry, with weights V = V0, interpolated by the
// hats (L = sum V H), keeps constants. A linear field it gives back with the node's value taken at the centre c of the
// node's points, not at the node x: at a free surface a third of a cell and more inside. Q = H L^-1 (L + C) L^-1 H^T V
// moves it there. With F = L (x - c) of the points of an element alone, four nodes and two axes, and S = F^T c (c: of all
// points of the nodes),
//   C = sum over elements of F S^-1 F^T,
// so that C 1 = 0 and C c = sum F = L (x - c): Q keeps constants and linear fields wherever points lie, and so does the
// sum of V Q a keep that of V a. Q^* = V^-1 Q^T V has S^-T in the place of S^-1. The force uses Q, the strain Q^*: they
// are conjugate. In lengths of V neither is greater than 1 but by some per cent where points are few and scattered.
#pragma once

#include "mpm/grid_state.hpp"

namespace pivnp::mpm {

enum class Averaging { of_stress, of_strain };  // Q and Q^*

/// Node::dx, the means over the hats, and Node::dy, the hats' volumes, become: dx what Q or Q^* gives the node.
/// AveragedCell's sums are set.
void move_means_to_nodes(GridState& g, Averaging which, int threads);

}  // namespace pivnp::mpm

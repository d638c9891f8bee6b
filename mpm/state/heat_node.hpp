// What the nodes of the grid carry of heat during a step.
#pragma once

namespace pivnp::mpm {

/// Sums over points by hats between nodes, and of the element up and to the right of the node; all zero between steps. C: a
/// point's heat capacity; V: its volume; s, t: its place in the element, in cells.
struct alignas(32) HeatNode {
  double capacity = 0;   // C, J/(m K)
  double diffusing = 0;  // C times the diffusivity D
  double heat = 0;       // C D T
  double inside = 0;     // element: V
  double resisting = 0;  // element: V over the conductivity
  double contained = 0;  // element: C
  double along_x = 0, along_y = 0;  // element: C s (1 - s), C t (1 - t)
  double temperature = 0;  // of the node's points, or given
  double gain = 0;       // in this step, J/m
  double evened = 0;     // of it, what only takes the place of what points pass on at the rate of a cell; then that temperature
  double change = 0;     // of all points, K
};

}  // namespace pivnp::mpm

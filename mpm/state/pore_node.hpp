// What the nodes of the grid carry of the water during a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace pivnp::mpm {

/// Sums over points that hold water; all zero between steps. The functions of the flow are hats between nodes, whatever the shape
/// functions of the momentum. V: the points' volumes; s, t: their places in the element, in cells.
struct alignas(32) PoreNode {  // by the hats
  double volume = 0;      // V, m^2
  double potential = 0;   // V e, e = p - rho g . x, times the mobility where that varies
  double strained = 0;    // V times the volumetric strain of the last step
  double mobile = 0;      // V times the mobility, or, where that is the same everywhere, the pores' volume
};
/// Of the element up and to the right of a node.
struct alignas(32) PoreElement {
  double inside = 0;      // V
  double along_x = 0, along_y = 0;  // V s (1 - s), V t (1 - t)
  double conducting = 0;  // V times the mobility, or V
};
static_assert(sizeof(PoreNode) == 32 && std::is_trivially_copyable_v<PoreNode>);
static_assert(sizeof(PoreElement) == 32 && std::is_trivially_copyable_v<PoreElement>);
struct PoreSumsView {
  PoreNode* node;
  PoreElement* element;
};

/// What is known of a node, and of the element up and to the right of it, beside the sums.
struct PoreMark {
  std::uint16_t loaded : 14 = 0;  // one more than the number of a traction's boundary whose points are in an element beside it
  std::uint16_t solid : 1 = 0;    // the element holds material without pores
  std::uint16_t given : 1 = 0;    // the potential, by a boundary or the material's own surface
};
inline constexpr std::uint16_t most_marked = (1u << 14) - 1;
static_assert(sizeof(PoreMark) == 2);

/// Of the nodes: means, and what they pass on to their points. Numbers of a row lie side by side, a row and more before the first.
struct PoreFields {
  double* volume;    // V; 0: no water
  double* potential; // the mean of e, or what is given, Pa
  double* mean;      // of the strain, then what takes its successor
  double* even;      // V over a quarter of that of the elements around, 1 at most; then the mean without waves of two cells;
                     // then the strain that feeds pressure
  double* change;    // of the water in a unit of volume, in this step
  double* rate;      // mobility, where it varies: by it and V points weigh in `potential`, and share what flows in
  // Weights, in single precision: what two nodes exchange has the same one on both sides, so that sums are kept to round-off.
  float* weight;     // of the element up and to the right in smoothing: V times the least share (`even`) of its nodes
  // Of the edges to the right and up.
  float *flow_x, *flow_y;      // exchange of water for a difference of potential, in this step
  float *strain_x, *strain_y;  // V s (1 - s), V t (1 - t) of both elements beside it, half
  double *inert_x = nullptr, *inert_y = nullptr;  // projected: the same for pressures, with what the skeleton yields to them
  std::ptrdiff_t row;
  // Axisymmetric, else null: the node's radius (at the axis a third of a cell: half a node's volume lies there), and the share
  // that is the node's of what flows along the axis in the elements right and left of it: their outer part is the larger.
  const double *radius = nullptr, *of_right = nullptr, *of_left = nullptr;
};

/// Of a node, where pores are not full (pore_front.cpp); all zero between steps. S: the share of a point's pores that is full.
struct PoreFrontNode {
  double all = 0;        // volume of the points whose pores may hold water, by their hats
  double wet = 0;        // of that, times S
  double potential = 0;  // mean over what is wet, or given
  double strained = 0;   // volumetric strain of the last step, likewise
  double inflow = 0, restore = 0, unseen = 0, change = 0;
  double room = 0;       // volume that gains reach
  std::uint16_t loaded = 0;
  bool holds = false;    // the element up and to the right: material
  bool given = false, seeps = false;

  bool known() const { return wet > 0 || given; }
};

}  // namespace pivnp::mpm

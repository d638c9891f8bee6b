// The fields of the nodes, listed once: what a node takes of memory is counted from the list (step/memory.hpp). All are of one
// step: none is state, none is recorded, and all are double precision but for the marks. A field that a case does not need
// takes no memory, or no more than pages that nothing writes to.
#pragma once

#include <string_view>

#include "mpm/state/node.hpp"
#include "mpm/state/pore_node.hpp"

namespace pivnp::mpm {

/// Who needs fields that not every case has.
struct NodeNeeds {
  bool own_strain_velocity = false;  // stress first or from velocities mapped again; small-mass nodes and restraints that act on it
  bool averages = false;             // fbar with shapes of three nodes
  bool filtered = false;             // XPIC
  bool loads = false;                // body forces, tractions
  bool wet = false;                  // water in the pores
  bool averaged = false;             // a law's softening follows the strain around a point (transfer/nonlocal.hpp)
};

struct NodeField {
  std::string_view name, unit, definition;
  bool NodeNeeds::*need = nullptr;  // without it the field takes no memory; null: every case has it
};

/// In place of a component's member: a field that lies in an array of its own, an element T a node.
template <class T>
struct InArray {
  using type = T;
};

/// Calls visit(field, component, ...): with the members of Node for what lies in a node's line, else with one InArray.
template <class Visit>
constexpr void for_each_node_field(Visit&& visit) {
  using N = NodeNeeds;
  visit(NodeField{"mass", "kg/m", "mass mapped from the points"}, &Node::mass);
  visit(NodeField{"velocity", "m/s", "velocity mapped from the points; while it is being mapped, momentum"}, &Node::vx, &Node::vy);
  visit(NodeField{"force", "N/m", "force without the damping"}, &Node::fx, &Node::fy);
  visit(NodeField{"updated velocity", "m/s", "velocity after the momentum update and the restraints"}, &Node::nx, &Node::ny);
  visit(NodeField{"held", "", "held by a wall or body"}, &Node::held);
  visit(NodeField{"apart", "", "strains the material by a velocity of its own"}, &Node::apart);
  visit(NodeField{"strain-rate velocity", "m/s", "velocity that gives the strain increments, where it is not the updated one",
                  &N::own_strain_velocity},
        InArray<NodeVelocity>{});
  visit(NodeField{"edges", "m^2", "sums over a cell's points for its edges, then their shares", &N::averages},
        InArray<CellEdges>{});
  visit(NodeField{"corners", "Pa m^2, m^2", "sums over a corner's points, then their average", &N::averages},
        InArray<CornerSums>{});
  visit(NodeField{"shift", "1", "from the centre of a corner's points to the corner, in cells", &N::averages},
        InArray<AlongAxes>{});
  visit(NodeField{"fluxes", "1", "what moves a corner's average to the corner", &N::averages},
        InArray<AlongAxes>{});
  visit(NodeField{"filtered velocity", "m/s", "velocity, filtered to an order", &N::filtered}, InArray<NodeVelocity>{});
  visit(NodeField{"body force", "N/m", "force of body forces and tractions", &N::loads}, InArray<NodeVelocity>{});
  visit(NodeField{"pores", "", "what the flow of water needs of a node (pore_node.hpp)", &N::wet}, InArray<PoreNode>{}, InArray<PoreElement>{}, InArray<PoreMark>{});
  visit(NodeField{"flow", "", "means, and what nodes pass on of the water (PoreFields)", &N::wet}, InArray<double>{}, InArray<double>{},
        InArray<double>{}, InArray<double>{}, InArray<double>{}, InArray<double>{}, InArray<double>{}, InArray<double>{}, InArray<double>{},
        InArray<double>{}, InArray<double>{});
  visit(NodeField{"softening strain", "m^2", "plastic strain times volume, then its mean", &N::averaged},
        InArray<double>{});
  visit(NodeField{"softening volume", "m^2", "volume, filtered alike", &N::averaged}, InArray<double>{});
}

}  // namespace pivnp::mpm

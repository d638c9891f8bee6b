// The fields of the nodes, listed once: arrays are allocated by the list, and what a node takes of memory is counted from it
// (step/memory.hpp). All are of one step: none is state, none is recorded, and all are double precision but for the marks and the
// weights of the water's flow. A field that a case does not need takes no memory.
#pragma once

#include <cstddef>
#include <string_view>
#include <type_traits>

#include "mpm/state/heat_node.hpp"
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
  bool wet_rings = false;            // the same about an axis
  bool wet_soils = false;            // its mobility is not the same everywhere
  bool heated = false;               // temperature
  bool averaged = false;             // a law's softening follows the strain around a point (transfer/nonlocal.hpp)
};

struct NodeField {
  std::string_view name, unit, definition;
  bool NodeNeeds::*need = nullptr;  // without it the field takes no memory; null: every case has it
};

/// What does not lie in a node's line: arrays of their own, an element a node; empty where a case does not need them.
struct NodeArrays {
  OfGrid<NodeVelocity> own_strain_velocity;
  OfGrid<CellEdges> edges;
  OfGrid<CornerSums> corners;
  OfGrid<AlongAxes> shift, fluxes;
  OfGrid<NodeVelocity> filtered, loads;
  OfGrid<PoreNode> pores;
  OfGrid<PoreElement> pore_elements;
  OfGrid<PoreMark> pore_marks;
  SeveralOfGrid<double, 5> flow;
  SeveralOfGrid<float, 5> flow_weights;
  OfGrid<double> flow_rate;
  SeveralOfGrid<double, 3> rings;
  OfGrid<HeatNode> heat;
  OfGrid<double> softening_strain, softening_volume, softening_rows;

  /// Those that are needed, all zero, of so many elements.
  void allocate(std::size_t size, const NodeNeeds& needs);
};

/// Calls visit(field, member, ...): with the members of Node for what lies in a node's line, else with one of NodeArrays.
template <class Visit>
constexpr void for_each_node_field(Visit&& visit) {
  using N = NodeNeeds;
  visit(NodeField{"mass", "kg/m", "mass mapped from the points"}, &Node::mass);
  visit(NodeField{"velocity", "m/s", "velocity mapped from the points; while it is being mapped, momentum"}, &Node::vx, &Node::vy);
  visit(NodeField{"force", "N/m", "force without the damping"}, &Node::fx, &Node::fy);
  visit(NodeField{"updated velocity", "m/s", "velocity after the momentum update and the restraints"}, &Node::nx, &Node::ny);
  visit(NodeField{"held", "", "held by a wall or body, along each axis"}, &Node::held_x, &Node::held_y);
  visit(NodeField{"apart", "", "strains the material by a velocity of its own"}, &Node::apart);
  visit(NodeField{"strain-rate velocity", "m/s", "velocity that gives the strain increments, where it is not the updated one",
                  &N::own_strain_velocity},
        &NodeArrays::own_strain_velocity);
  visit(NodeField{"edges", "m^2", "sums over a cell's points for its edges, then their shares", &N::averages},
        &NodeArrays::edges);
  visit(NodeField{"corners", "Pa m^2, m^2", "sums over a corner's points, then their average", &N::averages},
        &NodeArrays::corners);
  visit(NodeField{"shift", "1", "from the centre of a corner's points to the corner, in cells", &N::averages},
        &NodeArrays::shift);
  visit(NodeField{"fluxes", "1", "what moves a corner's average to the corner", &N::averages},
        &NodeArrays::fluxes);
  visit(NodeField{"filtered velocity", "m/s", "velocity, filtered to an order", &N::filtered}, &NodeArrays::filtered);
  visit(NodeField{"body force", "N/m", "force of body forces and tractions", &N::loads}, &NodeArrays::loads);
  visit(NodeField{"pores", "", "what the flow of water needs of a node (pore_node.hpp)", &N::wet}, &NodeArrays::pores, &NodeArrays::pore_elements,
        &NodeArrays::pore_marks);
  visit(NodeField{"flow", "", "means, and what nodes pass on of the water (PoreFields)", &N::wet}, &NodeArrays::flow, &NodeArrays::flow_weights);
  visit(NodeField{"flow rate", "m^2/(Pa s)", "mobility of the water, where it varies (PoreFields)", &N::wet_soils}, &NodeArrays::flow_rate);
  visit(NodeField{"rings", "m, 1, 1", "radius, and the node's share of the flow along the axis in the elements beside it (PoreFields)", &N::wet_rings},
        &NodeArrays::rings);
  visit(NodeField{"heat", "", "what conduction needs of a node (heat_node.hpp)", &N::heated}, &NodeArrays::heat);
  visit(NodeField{"softening strain", "m^2", "plastic strain times volume, then its mean", &N::averaged},
        &NodeArrays::softening_strain);
  visit(NodeField{"softening volume", "m^2", "volume, filtered alike", &N::averaged}, &NodeArrays::softening_volume);
  visit(NodeField{"softening rows", "m^2", "one of them, filtered along the rows", &N::averaged}, &NodeArrays::softening_rows);
}

inline void NodeArrays::allocate(std::size_t size, const NodeNeeds& needs) {
  for_each_node_field([&](const NodeField& field, const auto&... member) {
    const auto make = [&]<class Values, class Owner>(Values Owner::*values) {
      if constexpr (std::is_same_v<Owner, NodeArrays>)
        if (needs.*field.need) this->*values = Values(size);
    };
    (make(member), ...);
  });
}

}  // namespace pivnp::mpm

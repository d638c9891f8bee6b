// The fields of the nodes, listed once. All are of one step: none is state, none is recorded.
#pragma once

#include <cstddef>
#include <string_view>

#include "mpm/state/node.hpp"

namespace pivnp::mpm {

struct NodeField {
  std::string_view name, unit, definition;
};

/// What every node carries in its line (Node): calls visit(field, component, ...) with the members.
template <class Visit>
constexpr void for_each_node_field(Visit&& visit) {
  visit(NodeField{"mass", "kg/m", "mass mapped from the points"}, &Node::mass);
  visit(NodeField{"velocity", "m/s", "velocity mapped from the points; while it is being mapped, momentum in N s/m"}, &Node::vx,
        &Node::vy);
  visit(NodeField{"force", "N/m", "force without the damping"}, &Node::fx, &Node::fy);
  visit(NodeField{"updated velocity", "m/s", "velocity after the momentum update and the restraints"}, &Node::nx, &Node::ny);
  visit(NodeField{"held", "", "by a wall or body"}, &Node::held);
  visit(NodeField{"apart", "", "strains the material by a velocity of its own (NodeNeeds::strain_velocity)"}, &Node::apart);
}

}  // namespace pivnp::mpm

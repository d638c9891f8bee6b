#include "mpm/grid/averages.hpp"

namespace pivnp::mpm {

namespace {

// Beyond the grid a row and one more are read before it, two rows and some after.
std::size_t room_for(const Grid& nodes) { return nodes.node_count() + 3 * std::size_t(nodes.nx) + 8; }

}  // namespace

Averages::Averages(const Grid& nodes)
    : row_(nodes.nx), edges_(room_for(nodes)), corners_(room_for(nodes)), shift_(room_for(nodes)), fluxes_(room_for(nodes)) {}

AverageArrays Averages::arrays() {
  const std::size_t first = std::size_t(row_) + 1;
  return {edges_.data() + first, corners_.data() + first, shift_.data() + first, fluxes_.data() + first, row_};
}

AverageView Averages::view() {
  const AverageArrays a = arrays();
  return {a.edges, a.corners};
}

void Averages::forget(std::uint32_t n) {
  const AverageArrays a = arrays();
  a.edges[n] = {};
  a.corners[n] = {};
  a.shift[n] = {};
  a.fluxes[n] = {};
}

}  // namespace pivnp::mpm

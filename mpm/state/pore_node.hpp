// What a node of the grid carries of the water during a step.
#pragma once

#include <cstdint>
#include <type_traits>

namespace pivnp::mpm {

/// One line of the caches; all zero between steps. The functions of the flow are hats between nodes, whatever the shape
/// functions of the momentum.
struct alignas(64) PoreNode {
  double volume = 0;      // of the points that hold water, by their hats, m^2
  double potential = 0;   // p - rho g . x, the mean over that volume or what a boundary gives, Pa
  double strained = 0;    // volumetric strain of the last step, mean over that volume
  double inflow = 0;      // volume of water that the gradients bring, m^2/s
  double restore = 0;     // what the points' potentials lack to the field of the nodes, times mobility and volume, m^4/s
  double unseen = 0;      // mean of what the points exchange for the nodes' blindness (PoreWater::change_points)
  double change = 0;      // of the water in a unit of volume, in this step
  std::uint8_t cell = 0;  // of the element up and to the right: PoreCell
  bool given = false;     // the potential, by a boundary or the material's own surface
  std::uint16_t loaded = 0;  // one more than the number of a traction's boundary whose points are in an element beside it
};
static_assert(sizeof(PoreNode) == 64 && std::is_trivially_copyable_v<PoreNode>);

enum PoreCell : std::uint8_t {
  holds_water = 1,
  holds_solid = 2,  // material without pores
};

}  // namespace pivnp::mpm

// What a boundary restrains, and where.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "mpm/grid/grid_geometry.hpp"

namespace pivnp::mpm {

struct Wall {
  std::string key;                   // boundary.NAME
  BoundaryType type;                 // any but traction
  Vec2 velocity = Vec2::Zero();      // fixed: given to the nodes
  Vec2 normal = Vec2::Zero();        // out of the material
  double friction = 0;
  double until = std::numeric_limits<double>::infinity();
  std::uint8_t side = wall_none;       // of its nodes on which nothing is (WallSide)
  Vec2 shift = Vec2::Zero();           // of its nodes, onto it, m
  std::array<double, 2> impedance{};   // times the length that belongs to a node, kg/(m s)
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  std::vector<std::uint32_t> nodes;  // of the first velocity field, in the order of their index
  std::vector<double> release;       // when each of them is let go
};

/// rho c_p and rho c_s of the material near a point, kg/(m^2 s).
using Impedance = std::function<std::array<double, 2>(const Vec2&)>;

/// A line restrains the nodes within half a cell of it; of two rows at equal distance, the outer one. A line's normal
/// defaults to the one away from `centroid` (of the material). Beside lines along the grid shapes of three nodes are
/// modified. Where one that is neither tied nor absorbing lies between lines of nodes, nodes are moved onto it if they
/// may (shape.hpp). Any other line restrains, for these shapes, the row of nodes behind it too. What is tied makes two
/// walls, one after the other. Throws InputError naming boundary.<name>.<key>.
std::vector<Wall> walls_of(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries,
                           const GridGeometry& g, const Vec2& centroid, const Impedance& impedance,
                           bool may_move = true);

/// A region is filled with whole points; those beside a wall that has moved nodes are made to end at it, where a
/// uniform stress is in balance: their areas change by half at most.
void fill_up_to_walls(const std::vector<Wall>& walls, const GridGeometry& g, ParticleSet& points);

}  // namespace pivnp::mpm

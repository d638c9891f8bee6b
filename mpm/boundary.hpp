// Restraints on nodes: walls, bases, gates.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mpm/grid_state.hpp"
#include "mpm/options.hpp"

namespace pivnp::mpm {

/// What a wall or body did to a node in a step: impulse on the material (N s/m) and the wall's own velocity.
struct Reaction {
  std::uint32_t node;
  double impulse_x, impulse_y;
  double wall_x, wall_y;
};

/// fixed: no motion. roller: no motion along the normal, either way. frictional: no motion along the normal outward;
/// the tangential impulse is at most friction times the normal one; separation is free (the nodal form of Coulomb's
/// law, as in Bardenhagen, Brackbill & Sulsky 2000 for a wall at rest).
class Restraints {
 public:
  /// A line restrains the nodes within half a cell of it; of two rows at equal distance, the outer one. A line's normal
  /// defaults to the one away from `centroid` (of the material). Throws InputError naming boundary.<name>.<key>.
  Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const Grid& grid,
             const Vec2& centroid);

  /// Restrains Node::nx, ny; the impulses are appended to `reactions`.
  void apply(double time, GridState& g, std::vector<Reaction>& reactions);
  /// Restrains Node::ux, uy alike; nodes that stuck in apply() stay.
  void apply_to_remapped(double time, GridState& g) const;
  /// The first time after `time` at which a restraint goes.
  double next_change(double time) const;

 private:
  enum class Type : std::uint8_t { fixed, roller, frictional };
  struct Wall {
    Type type;
    Vec2 normal;  // out of the material
    double friction;
    double until = std::numeric_limits<double>::infinity();
  };
  struct RestrainedNode {
    std::uint32_t node;
    std::vector<std::uint16_t> walls;
    bool stuck = false;
  };
  void add_nodes(const std::string& key, const BoundaryOptions& options, Wall& wall, const Grid& grid,
                 const Vec2& centroid, std::vector<std::vector<std::uint16_t>>& walls_of_node);
  Vec2 restrain(const RestrainedNode& at, double time, Vec2 v, bool with_friction, bool& stuck) const;

  std::vector<Wall> walls_;
  std::vector<RestrainedNode> nodes_;
};

}  // namespace pivnp::mpm

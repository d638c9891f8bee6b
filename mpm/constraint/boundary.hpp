// Restraints on nodes: walls, bases, gates.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mpm/grid/grid_state.hpp"
#include "mpm/constraint/options.hpp"

namespace pivnp::mpm {

/// What a wall or body did to a node in a step: impulse on the material (N s/m) and the wall's own velocity.
struct Reaction {
  std::uint32_t node;
  double impulse_x, impulse_y;
  double wall_x, wall_y;
  int body = -1;  // index of the rigid body; -1: a wall
};

/// fixed: no motion. roller: no motion along the normal, either way. frictional: no motion along the normal outward;
/// the tangential impulse is at most friction times the normal one; separation is free (the nodal form of Coulomb's
/// law, as in Bardenhagen, Brackbill & Sulsky 2000 for a wall at rest). absorbing: dashpots rho c_p across and rho c_s
/// along the wall (Lysmer & Kuhlemeyer 1969), taken implicitly, so that they do not bound the step.
///
/// tied: a node and the one opposite move as one, with their common momentum: layers between two such sides shear without
/// bending, as in a laminar box (tied degrees of freedom: Zienkiewicz, Bicanic & Shen 1988); material that leaves by one
/// comes in by the other. A state that is the same all along the slope is then exact, whatever the sides' distance.
///
/// A fixed restraint may give its nodes a velocity; any may be drawn away at a speed (a gate): each node is let go when
/// the moving shape has passed it.
///
/// A line along the grid through nodes restrains those nodes; shapes of three nodes are modified beside it
/// (shape.hpp), also under absorbing walls. Any other line restrains, for such shapes, the row of nodes behind it too.
class Restraints {
 public:
  /// rho c_p and rho c_s of the material near a point, kg/(m^2 s).
  using Impedance = std::function<std::array<double, 2>(const Vec2&)>;

  /// A line restrains the nodes within half a cell of it; of two rows at equal distance, the outer one. A line's normal
  /// defaults to the one away from `centroid` (of the material). Throws InputError naming boundary.<name>.<key>.
  Restraints(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const GridState& g,
             const Vec2& centroid, const Impedance& impedance);

  /// Restrains Node::nx, ny; the impulses are appended to `reactions`. With dt = 0 (initial equilibrium) absorbing walls are fixed.
  void apply(double time, double dt, GridState& g, std::vector<Reaction>& reactions);
  /// The motion that apply() left a node, as a projection: the unit matrix where no wall holds it.
  Mat2 mobility(std::size_t node) const;
  /// Restrains the strain-rate velocity alike; nodes that stuck in apply() stay.
  void apply_to_remapped(double time, GridState& g, bool equilibrium = false) const;
  /// The first time after `time` at which a restraint goes.
  double next_change(double time) const;
  /// Behind which walls nothing is, for every node of the grid (Fold).
  std::vector<std::uint8_t> wall_sides(double time, const Grid& grid) const;
  bool any_absorbing() const;
  bool any_tied() const;
  /// Points that have passed a tied side come in by the opposite one; Particles::carried holds by how much.
  void carry_over(double time, Particles& p) const;

 private:
  using Type = BoundaryType;  // but traction, which restrains nothing
  struct Wall {
    Type type;
    Vec2 velocity = Vec2::Zero();  // fixed: given to the nodes
    Vec2 normal;  // out of the material
    double friction;
    double until = std::numeric_limits<double>::infinity();
    std::uint8_t side = wall_none;  // on which nothing is
    std::array<double, 2> impedance{};  // times the length that belongs to a node, kg/(m s)
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  };
  struct RestrainedNode {
    std::uint32_t node;
    std::vector<std::uint16_t> walls;
    std::vector<double> until;  // of each wall at this node: the wall's, or when its withdrawal passes the node
    bool stuck = false;
    Mat2 mobility = Mat2::Identity();
  };
  void add_nodes(const std::string& key, const BoundaryOptions& options, Wall& wall, const GridState& g,
                 const Vec2& centroid, std::vector<std::vector<std::uint16_t>>& walls_of_node);
  double release(const BoundaryOptions& options, const Wall& wall, const Vec2& node, double spacing) const;
  Mat2 mobility_of(const RestrainedNode& at, double time, const Vec2& free, bool equilibrium) const;
  Vec2 given_velocity(const RestrainedNode& at, double time, bool equilibrium) const;
  Vec2 absorbed(const RestrainedNode& at, double time, double dt, const GridState& g, Vec2 v) const;
  Vec2 restrain(const RestrainedNode& at, double time, Vec2 v, bool with_friction, bool& stuck, bool equilibrium) const;

  void tie(const std::string& key, const GridState& g,
           const std::vector<std::vector<std::uint16_t>>& walls_of_node);
  struct Tie {
    std::uint32_t node[2];
    double until;
  };
  std::vector<Tie> ties_;
  struct Seam {
    Vec2 from, across;
    double until;
  };
  std::vector<Seam> seams_;
  std::vector<Wall> walls_;
  std::vector<RestrainedNode> nodes_;  // in the order of their index
  std::vector<double> changes_;  // times at which a restraint goes somewhere
};

}  // namespace pivnp::mpm

// Two sides that move as one.
//
// A node and the one opposite move with their common momentum: layers between two such sides shear without bending, as in
// a laminar box (tied degrees of freedom: Zienkiewicz, Bicanic & Shen 1988); material that leaves by one comes in by the
// other. A state that is the same all along the slope is then exact, whatever the sides' distance. Three-node shapes reach a node
// beyond each side, which is one with the node that lies as far inside the opposite one. The opposite side may be shifted along itself by
// whole cells: what is the same all along a slope that is inclined to the grid repeats so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mpm/constraint/reaction.hpp"
#include "mpm/constraint/wall.hpp"
#include "mpm/grid/grid_state.hpp"

namespace pivnp::mpm {

class TiedSides {
 public:
  /// The nodes of two opposite walls. Throws InputError naming boundary.<name>.across_m.
  void tie(const Wall& first, const Wall& second, const GridGeometry& g);
  bool any() const { return !ties_.empty(); }

  /// Node::nx, ny; the impulses are appended to `reactions`.
  void apply(double time, GridState& g, std::vector<Reaction>& reactions) const;
  /// The strain-rate velocity, of nodes that have one of their own, or (`equilibrium`) of all.
  void apply_to_strain_velocity(double time, GridState& g, bool equilibrium) const;
  /// Points that have passed a side come in by the opposite one; Particles::carried holds by how much.
  void carry_over(double time, Particles& p) const;

  /// On the sides.
  struct Tie {
    std::uint32_t node[2];
    double until;
    bool along_y;  // sides
  };
  const std::vector<Tie>& ties() const { return ties_; }
  /// Nodes that are one: those on the sides, and those beyond with those inside.
  struct Ring {
    std::vector<std::uint32_t> nodes;
    double until;
  };
  const std::vector<Ring>& rings() const { return rings_; }

 private:
  void tie_rings(const Tie& tie, std::ptrdiff_t next, std::ptrdiff_t period, std::ptrdiff_t offset, bool beyond);

  struct Seam {
    Vec2 from, across, normal;  // along the grid, of length 1/(the sides' distance)
    double until;
  };
  std::vector<Tie> ties_;
  std::vector<Ring> rings_;
  std::vector<Seam> seams_;
};

}  // namespace pivnp::mpm

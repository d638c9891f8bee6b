// What the boundaries do to the water.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "mpm/constraint/wall.hpp"
#include "mpm/grid/grid_geometry.hpp"

namespace pivnp::mpm {

/// Impervious, unless the boundary gives the pressure or the flow.
struct PoreCondition {
  enum Kind : std::uint8_t { impervious, drained, pressure, flux, level } kind = impervious;
  double value = 0;  // pressure, Pa; flux, m/s; height of the water's surface, m

  bool gives_pressure() const { return kind == drained || kind == pressure || kind == level; }
};

class PoreBoundaries {
 public:
  /// Throws InputError naming boundary.<name>.<key>.
  PoreBoundaries(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const std::vector<Wall>& walls,
                 const GridGeometry& g);

  /// Of a boundary by its number: of the faces of tractions.
  const PoreCondition& of_boundary(std::size_t boundary) const { return conditions_[boundary]; }
  bool any_flux_on_tractions() const { return flux_on_tractions_; }
  bool gives_flux(std::size_t boundary) const { return conditions_[boundary].kind == PoreCondition::flux; }
  /// Beside two loads, does a node take the condition of `a` rather than that of `b`? A given flow comes before others.
  bool comes_before(std::size_t a, std::size_t b) const {
    return gives_flux(a) == gives_flux(b) ? a > b : gives_flux(a);
  }
  bool any_level() const { return level_; }
  bool any_flux() const { return flux_; }

  /// Of a wall's node now, of any velocity field; null: the node is at no wall, or only at walls along the grid that let nothing through (what lies
  /// behind those is told by GridGeometry::walls). Others hold the water back wherever they hold a node.
  const PoreCondition* at(std::size_t node, double time) const;
  /// Does such a wall let water through now?
  bool passes(std::size_t node, double time) const {
    const PoreCondition* condition = at(node, time);
    return condition && condition->kind != PoreCondition::impervious;
  }
  /// Nodes of walls that let water through, at any time.
  const std::vector<std::uint32_t>& let_through() const { return let_through_; }
  /// The side on which the same wall has nothing (WallSide); wall_none where it is not along the grid.
  std::uint8_t side(std::size_t node, double time) const;
  /// Throws InputError if one that lets water through has material on both sides. `full`: does the element up and to the right
  /// of a node hold material?
  template <class Full>
  void check_outside(const GridGeometry& g, Full&& full) const {
    for (const AtNode& at : nodes_) {
      if (conditions_[at.boundary].kind == PoreCondition::impervious) continue;
      const auto i = std::ptrdiff_t(at.node) % g.grid.nx, j = std::ptrdiff_t(at.node) / g.grid.nx;
      if (i > 0 && j > 0 && full(std::size_t(at.node)) && full(std::size_t(at.node) - 1) &&
          full(std::size_t(at.node) - std::size_t(g.grid.nx)) && full(std::size_t(at.node) - std::size_t(g.grid.nx) - 1))
        refuse_inside(at.boundary);
    }
  }

 private:
  struct AtNode {
    std::uint32_t node;
    std::uint16_t boundary;
    std::uint8_t side;
    double until;
  };
  const AtNode* standing(std::size_t node, double time) const;
  [[noreturn]] void refuse_inside(std::size_t boundary) const;

  std::vector<std::string> keys_;
  std::vector<PoreCondition> conditions_;
  std::vector<AtNode> nodes_;        // what lets water through first, then by node
  std::vector<std::int32_t> first_;  // of every node of the first velocity field: its first place among them; -1: none
  std::vector<std::uint32_t> let_through_;
  bool flux_on_tractions_ = false, flux_ = false, level_ = false;
};

}  // namespace pivnp::mpm

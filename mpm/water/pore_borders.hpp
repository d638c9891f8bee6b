// Borders of soils: the strain of each side drives the pressures of its own points.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mpm/grid/grid_state.hpp"
#include "mpm/state/pore_node.hpp"
#include "mpm/water/pore_soil.hpp"

namespace pivnp::mpm {

inline constexpr std::uint8_t several_soils = 255;

/// Of each soil, one more than the number of its kind: soils of one kind have the same permeability, stiffness and porosity.
std::vector<std::uint8_t> kinds_of(const std::vector<PoreSoil>& soils);

/// The smoothed strain N S (2 - M S) theta of a step beside borders (docs/theory/mpm_water.md#flow, borders of soils). A node with points of
/// several kinds of soil is one node for each; S passes nothing through the elements around it.
class StrainAtBorders {
 public:
  /// `kind_in`: of each element's points, or several_soils; `kind(k)`: of a point, 0 where it takes no part.
  StrainAtBorders(const Particles& p, const GridState& g, const PoreFields& f, std::span<const std::uint8_t> kind_in,
                  const std::vector<std::uint8_t>& kinds, const std::function<std::uint8_t(std::uint32_t)>& kind, int threads);
  bool any() const { return !nodes_.empty(); }
  /// Before S: nothing is smoothed through the nodes.
  void part(const PoreFields& f) const;
  /// `even` is S theta, and `mean` (2 - M S) theta of all points together: of each kind instead, and at the border zero.
  void take(const PoreFields& f);
  /// From the points' water, what the nodes at the border have of their kind.
  void feed(Particles& p, const GridState& g, const std::function<std::uint8_t(std::uint32_t)>& kind, int threads) const;

 private:
  struct Sums {
    double volume = 0, strained = 0, fed = 0;  // `fed`: (2 - M S) theta
  };
  struct Element {
    double along_x = 0, along_y = 0;
  };
  bool at_border(std::size_t node) const { return place_[node] > 0; }
  Sums& sums(std::size_t node, std::size_t kind) { return of_nodes_[(place_[node] - 1) * kinds_ + kind - 1]; }
  const Sums& sums(std::size_t node, std::size_t kind) const { return of_nodes_[(place_[node] - 1) * kinds_ + kind - 1]; }
  bool beside(std::size_t element) const {
    return at_border(element) || at_border(element + 1) || at_border(element + row_) || at_border(element + row_ + 1);
  }

  std::size_t row_, kinds_;
  std::vector<std::uint32_t> nodes_, place_;  // at the border; of each node, one more than its place among them
  std::vector<Sums> of_nodes_;                // and of their kinds
  std::vector<std::uint32_t> element_place_;  // likewise of elements beside
  std::vector<Element> of_elements_;
};

}  // namespace pivnp::mpm

// What the boundaries do to heat.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mpm/constraint/options.hpp"
#include "mpm/constraint/wall.hpp"
#include "mpm/grid/grid_geometry.hpp"

namespace pivnp::mpm {

/// No heat passes, unless the boundary gives the temperature, the heat, or what lies beyond it.
struct HeatCondition {
  enum Kind : std::uint8_t { temperature, flux, convective } kind = temperature;
  double value = 0;     // degrees, W/m^2, degrees of what lies beyond
  double transfer = 0;  // convective, W/(m^2 K)
};

class HeatBoundaries {
 public:
  /// Throws InputError naming boundary.<name>.<key>.
  HeatBoundaries(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries, const std::vector<Wall>& walls);

  struct AtNode {
    std::uint32_t node;  // of the first velocity field
    HeatCondition condition;
    std::uint8_t side;   // on which the wall has nothing (WallSide)
    double until;
  };
  /// By node, each once at a time: temperatures first.
  const std::vector<AtNode>& nodes() const { return nodes_; }

 private:
  std::vector<AtNode> nodes_;
};

/// Throws InputError where heat's keys are given without [heat].
void refuse_heat_keys(const std::vector<std::pair<std::string, BoundaryOptions>>& boundaries);

}  // namespace pivnp::mpm

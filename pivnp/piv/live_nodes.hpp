// Which nodes a mask leaves anything to be measured about: no work is done for the others.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/lattice.hpp"

namespace pivnp::piv {

/// The nodes, off where the mask excludes every pixel within `reach` (in column and row, rounded up to tiles).
class LiveNodes {
 public:
  LiveNodes(NodeLattice nodes, float reach);
  /// Takes the mask of a pair; true if other nodes are on than before.
  bool take(const MaskView& mask);
  const NodeLattice& nodes() const { return live_; }

 private:
  static constexpr int tile = 16;
  NodeLattice nodes_, live_;
  float reach_;
  std::vector<std::uint8_t> tiles_;  // 1: holds a usable pixel; empty without a mask
};

}  // namespace pivnp::piv

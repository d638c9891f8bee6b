// Blocks of cells that may sleep (step/sleep.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pivnp/core/grid/grid.hpp"

namespace pivnp::mpm {

/// The points of a sleeping block keep their places, stresses and stillness. Those whose nodes the others' see, the rim,
/// are still mapped to them; the rest is not looked at.
class SleepingBlocks {
 public:
  static constexpr int side = 8;  // cells

  explicit SleepingBlocks(const Grid& grid) : nx_(grid.nx), ny_(grid.ny) {}
  int across() const { return (nx_ + side - 1) / side; }
  std::size_t count() const { return std::size_t(across()) * std::size_t((ny_ + side - 1) / side); }
  std::size_t of_cell(std::int32_t cell) const {
    return std::size_t(cell / nx_ / side * across() + cell % nx_ / side);
  }
  bool any() const {
    return std::any_of(asleep_.begin(), asleep_.end(), [](std::uint8_t a) { return a != 0; });
  }
  bool sleeps(std::int32_t cell) const { return !asleep_.empty() && asleep_[of_cell(cell)]; }
  /// Which blocks sleep from here on; empty: none.
  void set(std::vector<std::uint8_t> asleep) { asleep_ = std::move(asleep); }

 private:
  int nx_, ny_;
  std::vector<std::uint8_t> asleep_;  // of each block; empty: none
};

}  // namespace pivnp::mpm

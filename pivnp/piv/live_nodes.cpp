#include "pivnp/piv/live_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pivnp::piv {

LiveNodes::LiveNodes(NodeLattice nodes, float reach) : nodes_(std::move(nodes)), live_(nodes_), reach_(reach) {}

bool LiveNodes::take(const MaskView& mask) {
  std::vector<std::uint8_t> tiles;
  const int columns = (mask.width + tile - 1) / tile, rows = (mask.height + tile - 1) / tile;
  if (mask.data != nullptr) {
    tiles.assign(std::size_t(columns) * std::size_t(rows), 0);
    for (int r = 0; r < mask.height; ++r)
      for (int c = 0; c < mask.width; c += tile) {
        std::uint8_t& some = tiles[std::size_t(r / tile) * std::size_t(columns) + std::size_t(c / tile)];
        for (int k = c; !some && k < std::min(c + tile, mask.width); ++k) some = mask.usable(k, r);
      }
  }
  if (tiles == tiles_) return false;
  tiles_ = std::move(tiles);
  const std::vector<std::uint8_t> before = std::exchange(live_.on, nodes_.on);
  if (tiles_.empty()) return live_.on != before;
  live_.on.assign(nodes_.pixel.size(), 0);
  const auto first = [&](float at) { return std::max(0, static_cast<int>(std::floor(at - reach_)) / tile); };
  const auto last = [&](float at, int count) {
    return std::min(static_cast<int>(std::floor(at + reach_)) / tile, count - 1);
  };
  for (std::size_t k = 0; k < live_.on.size(); ++k) {
    const auto [x, y] = nodes_.pixel[k];
    if (!switched_on(nodes_, k) || !(std::abs(x) < 1e6f && std::abs(y) < 1e6f)) continue;
    for (int j = first(y); j <= last(y, rows) && !live_.on[k]; ++j)
      for (int i = first(x); i <= last(x, columns) && !live_.on[k]; ++i)
        live_.on[k] = tiles_[std::size_t(j) * std::size_t(columns) + std::size_t(i)];
  }
  return live_.on != before;
}

}  // namespace pivnp::piv

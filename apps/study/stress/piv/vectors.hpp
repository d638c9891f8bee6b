// What became of the vectors of a pair of frames whose displacement is known.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "apps/study/stress/survival_map.hpp"
#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/piv.hpp"

namespace pivnp::app {

inline constexpr Bounds vector_bounds{0.1, 0.5};  // px

/// A key of [piv] and its value, all of them: what results rest on.
std::string words_of(const piv::PivOptions& options);

struct KnownFrames {
  const Image &first, &second;
  std::function<Vec2(const Vec2& place, Anchor)> truth;  // px
  MaskView mask = {};
};

/// Measures on one thread; of nodes that are not `scored` (empty: all are) nothing is counted. Of frames in which the
/// blocks of a compression show no vector is trusted.
Survival measured(const piv::PivOptions& options, const piv::NodeLattice& nodes, const KnownFrames& frames, const std::vector<std::uint8_t>& scored = {});

}  // namespace pivnp::app

// Edges that move against the material: a shadow's, a beam's.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/normal_sums.hpp"

namespace pivnp::piv {

/// Takes from `good` ([ny][nx] of the sums' lattice) the points beside a step of the grey values, within four points of
/// it, whose displacement leaves those of both sides. Where material ends or slips at an edge, the displacement passes
/// from that of one side to that of the other; where it leaves both, what moves is not the material. `u`, `v`: the
/// field; `most_px`: how far it may leave both sides, or as far as these are apart; pixels of the level. Only where
/// both sides are good, eight points from each other: a thin layer that flows under air is no such edge.
void reject_moving_edges(const CellSums& sums, const std::vector<float>& u, const std::vector<float>& v, float most_px,
                         std::vector<std::uint8_t>& good);

}  // namespace pivnp::piv

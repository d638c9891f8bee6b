// What lies beyond the outline of a region that moves: material, or ground that does not move with it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "apps/study/pipeline/measure/moving_outline.hpp"
#include "apps/study/pipeline/scene/scene.hpp"

namespace pivnp::app {

/// Judges for every point of the outlines what the frames of the pair show beyond it, within 24 px, by its
/// last known move: it stays where it was, or goes with the material. Both are held against each other pixel by pixel,
/// by the squared differences of grey values; where neither stands out by three standard errors and a fifth, what was
/// known stays (ground without texture too: it draws no vector). Blocks of 8 px that show by themselves that they move stay in:
/// grains may have left the outline behind.
/// Returns what of the first frame may be material, one byte a pixel; empty: all.
std::vector<std::uint8_t> judge_outside(const std::vector<std::uint8_t>& inside, const Setting& setting, std::array<int, 2> pair,
                                        const ImageView& first, const ImageView& second, int window_px, std::vector<MovingOutline>& outlines);

}  // namespace pivnp::app

// A survival map as a picture.
#pragma once

#include <string>

#include "apps/plot/canvas.hpp"
#include "apps/study/stress/survival_map.hpp"

namespace pivnp::app {

/// A trusted and right share from which a combination counts as ours.
inline constexpr double ours_share = 0.9;

/// A level as it stands along the axis.
std::string level_text(const MapAxis& axis, std::size_t k);

/// Of one map with labels, by its rows, mm.
double drawn_height_mm(const SurvivalMap& map);
/// Shares of each combination one over the other, theory's lines and ours, at a place of the canvas, mm.
void draw_map(plot::Canvas& canvas, const SurvivalMap& map, double left_mm, double top_mm, double width_mm);
/// What the colours are, in a line; returns its height, mm.
double draw_legend(plot::Canvas& canvas, double left_mm, double top_mm);

}  // namespace pivnp::app

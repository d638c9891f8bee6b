// What several figures are made of: panels of the world, colour bars, bands, scale bars and legends.
#pragma once

#include <string>
#include <vector>

#include "apps/plot/canvas.hpp"
#include "apps/plot/raster.hpp"
#include "apps/plot/scale.hpp"

namespace pivnp::plot {

/// "x (m)"; a quantity without a unit, or with "1", goes without brackets.
std::string axis_label(const std::string& what, const std::string& unit);

/// A horizontal colour bar with its ticks and label below; pointed where values lie beyond. `factor`: shown over stored.
void colour_bar(Canvas& canvas, double x_mm, double y_mm, double width_mm, const Scale& scale, double factor,
                const std::string& label);

/// Panel of a world box, equal aspect; numbers and labels on the axes only where asked for.
Panel world_panel(Canvas& canvas, double x_mm, double y_mm, double width_mm, double height_mm, const Box& box,
                  const std::string& unit, bool label_x, bool label_y);

/// A scale bar of the panel, a quarter of it at most, with its length at its right, beside the picture so that it hides
/// nothing: it ends at (`right_mm`, `y_mm`).
void scale_bar(Canvas& canvas, double right_mm, double y_mm, const Panel& panel, const Box& box, const std::string& unit);

/// Polygon between two curves, broken where a value is not finite.
void band(Canvas& canvas, const Panel& panel, const std::vector<double>& x, const std::vector<double>& lower,
          const std::vector<double>& upper, const Fill& fill);

/// Symbols along a curve, about forty at most.
void markers(Canvas& canvas, const Panel& panel, const std::vector<double>& x, const std::vector<double>& y,
             Marker marker, Rgb rgb);

/// From tail to tip in canvas units; a dot if it is too short to have a head.
void arrow(Painter& p, const Vec2& tail, const Vec2& tip, Rgb rgb);

/// A legend entry drawn by hand at (x, y), its text to the right; returns the x where the next may start, in mm.
enum class Key { line, dashed, dotted, dash_dot, band, disc, circle, square, triangle, cross, tile };
double legend(Canvas& canvas, double x_mm, double y_mm, Key key, Rgb rgb, const std::string& words, double gap_mm = 5);

}  // namespace pivnp::plot

// What several figures are made of. Internal to apps/report: includes Qt.
#pragma once

#include <string>
#include <vector>

#include "apps/plot/canvas.hpp"

namespace pivnp::report {

inline QString qt(const std::string& text) { return QString::fromStdString(text); }

/// "x (m)".
inline QString axis_label(const QString& what, const std::string& unit) {
  return unit.empty() || unit == "1" ? what : what + QStringLiteral(" (") + qt(unit) + QStringLiteral(")");
}

/// What a colour means.
struct Scale {
  Colours map = Colours::sequential;
  double lower = 0, upper = 1;
  bool below = false, above = false;  // values beyond the ends exist
  Rgb at(double value) const { return colour_at(map, (value - lower) / (upper - lower)); }
};

/// Covers the finite values but for the outermost 0.5 %: from 0 if they are not negative, symmetric and diverging if
/// both signs occur or `signed_values` is set. Never empty.
Scale scale_for(const std::vector<double>& values, bool signed_values);

/// A horizontal colour bar with its ticks and label below; pointed where values lie beyond.
void colour_bar(Sheet& sheet, double x_mm, double y_mm, double width_mm, const Scale& scale, double factor,
                const QString& label);

/// Panel of a world box, equal aspect; numbers and labels on the axes only where asked for.
QCPAxisRect* world_panel(Sheet& sheet, double x_mm, double y_mm, double width_mm, double height_mm, const Box& box,
                         const std::string& unit, bool label_x, bool label_y);

/// A scale bar with its length, lower right.
void draw_scale_bar(Sheet& sheet, QCPAxisRect* panel, const Box& box, const std::string& unit);

/// Draws a raster over the whole panel.
void raster_in(Sheet& sheet, QCPAxisRect* panel, const QImage& image);

/// Polygon between two curves, broken where a value is not finite; panel coordinates.
void band(Sheet& sheet, QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& lower,
          const std::vector<double>& upper, Rgb rgb, int alpha);

/// A curve; not finite values leave gaps.
QCPGraph* curve(Sheet& sheet, QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& y,
                const QPen& pen);

/// A grey vertical grid is left out; pale horizontal lines help to read values.
void pale_grid(QCPAxisRect* panel);

}  // namespace pivnp::report

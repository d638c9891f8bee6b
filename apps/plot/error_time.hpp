// Error against time, both logarithmic: methods, settings and programs as points, and the front of what is possible.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/plot/canvas.hpp"

namespace pivnp::plot {

struct ErrorTimePoint {
  std::string name;
  Symbol symbol;
  bool own = false;  // of this program: its name is bold and in the symbol's colour, and it lies on top
  double time = std::numeric_limits<double>::quiet_NaN(), error = time;
  double worst = std::numeric_limits<double>::quiet_NaN();  // a line goes up to it; NaN: none
};

/// Symbols that tell entries apart, in their order: discs in colours of the palette for one's own, grey shapes for the
/// others.
std::vector<Symbol> entry_symbols(const std::vector<bool>& own, double size_mm);

/// Those that no other point beats in both, quickest first.
std::vector<ErrorTimePoint> front(std::vector<ErrorTimePoint> points);

struct ErrorTimeChart {
  std::string time_label, error_label;
  double quickest = 1, slowest = 10;  // range of time
  double least = 1, greatest = 10;    // range of error
  bool time_numbers = true, error_numbers = true;
  bool names = false;                 // by the symbols, one's own first; where there is no place for a name, it is left out
  std::optional<double> asked = {};   // a line at the error that is asked for
  std::vector<ErrorTimePoint> points = {};
};

/// Draws the chart with its front as stairs: what is possible lies right of and above it. Points that are not finite are
/// left out.
void draw_error_time(Canvas& canvas, double x_mm, double y_mm, double width_mm, double height_mm,
                     const ErrorTimeChart& chart);

}  // namespace pivnp::plot

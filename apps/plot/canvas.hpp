// A figure canvas: panels placed in millimetres, axes, curves and symbols in them, and free painting. No Qt shows here.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/plot/painter.hpp"
#include "apps/plot/raster.hpp"

class QCPAxis;
class QCPAxisRect;

namespace pivnp::plot {

/// Starts Qt once: offscreen, without a display or a home, the locale of the process left as it was. A canvas starts it
/// too; all canvases must be made and drawn by the thread of the first.
void start_qt();

/// "QCustomPlot 2.1.1 on Qt 6.4.2": what draws the figures.
std::string drawing_libraries();

enum class Axis { x, y };

/// A panel of a canvas, with an x axis below and a y axis at the left. A handle: copies are the same panel, which lives
/// as long as its canvas. Places are in canvas units (painter.hpp) and known once the canvas is being drawn.
class Panel {
 public:
  double x(double value) const;
  double y(double value) const;
  Vec2 at(const Vec2& value) const { return {x(value.x()), y(value.y())}; }
  Rectangle frame() const;

  /// Range, label ("x (m)") and number of ticks wanted; ticks at 1, 2 or 5 times a power of ten.
  Panel& axis(Axis axis, double lower, double upper, const std::string& label, int ticks = 5);
  /// A logarithmic scale from a range that axis() was told; `decimals` of the mantissas at the ticks.
  Panel& logarithmic(Axis axis, double lower, double upper, int digits);
  /// Small ticks between those with numbers.
  Panel& small_ticks(Axis axis);
  /// Ticks at the multiples of `step`.
  Panel& step(Axis axis, double step);
  /// Whether ticks have numbers.
  Panel& numbers(Axis axis, bool shown);
  Panel& ticks(Axis axis, bool shown);
  /// Whether the line along the panel is drawn.
  Panel& base_line(Axis axis, bool shown);
  /// Line, ticks, numbers and label.
  Panel& visible(Axis axis, bool shown);
  /// Pale horizontal lines, which help to read values.
  Panel& pale_grid();
  double lower(Axis axis) const;

 private:
  friend class Canvas;
  explicit Panel(QCPAxisRect* rect) : rect_(rect) {}
  QCPAxis* of(Axis axis) const;

  QCPAxisRect* rect_;
};

class Canvas {
 public:
  Canvas(double width_mm, double height_mm);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  double width_mm() const { return width_mm_; }
  double height_mm() const { return height_mm_; }

  /// The inner rectangle's top left corner at (x, y); thin left and bottom axes, ticks outward.
  Panel panel(double x_mm, double y_mm, double width_mm, double height_mm);

  /// A line through the points in the order of x, and a symbol at each if given. Values that are not finite leave gaps.
  void curve(const Panel& panel, const std::vector<double>& x, const std::vector<double>& y, const Pen& pen,
             const std::optional<Symbol>& symbol = std::nullopt);
  void points(const Panel& panel, const std::vector<double>& x, const std::vector<double>& y, const Symbol& symbol);
  /// Covers the panel with a raster, below the axes.
  void raster(const Panel& panel, const Raster& raster);
  /// Covers a rectangle (mm) with one, above everything, its pixels left as they are.
  void raster_over(double x_mm, double y_mm, double width_mm, double height_mm, const Raster& raster);

  /// Paints below the axes, clipped to the panel.
  void paint(const Panel& panel, std::function<void(Painter&)> painting);
  /// Paints above everything, on the whole canvas.
  void paint_over(std::function<void(Painter&)> painting);
  void text(double x_mm, double y_mm, const std::string& words, Align align, const TextStyle& style = {});

  /// Draws at the painter's origin, which must be scaled to canvas units.
  void draw(QCPPainter& painter) const;
  std::string png(double dots_per_inch) const;
  std::string svg() const;

 private:
  struct Plot;
  double width_mm_, height_mm_;
  std::unique_ptr<Plot> plot_;
};

/// Writes FILE.svg and FILE.png (`file` without suffix) and makes the folder. Throws RunError naming the file.
void save(const Canvas& canvas, const std::filesystem::path& file, double dots_per_inch);

/// 1, 2 or 5 times a power of ten: nearest to range / count, so about `count` to the range.
double nice_step(double range, int count);
/// The step, or a lower one where fewer than two of its multiples lie between `lower` and `upper`: one tick tells no scale.
double step_with_ticks(double lower, double upper, double step);
/// The greatest such number that is not above `length`.
double nice_length(double length);

}  // namespace pivnp::plot

// A figure under construction: panels placed in millimetres, QCustomPlot's axes and curves in them, and free painting.
// Internal to apps/report: includes Qt.
#pragma once

#include <functional>
#include <memory>

#include <QByteArray>
#include <QColor>
#include <QFont>
#include <QImage>
#include <QString>
#include <qcustomplot.h>

#include "apps/plot/palette.hpp"
#include "apps/plot/raster.hpp"

namespace pivnp::report {

/// Starts Qt once: offscreen, without a display or a home, the locale of the process left as it was.
void start_qt();

/// Sheet units: tenths of a millimetre. Everything on a sheet is measured in them.
constexpr double units_per_mm = 10.0;
constexpr double units_per_point = units_per_mm * 25.4 / 72.0;

QColor colour(Rgb rgb, int alpha = 255);
QFont font(double points, bool bold = false);
QPen pen(Rgb rgb, double points, Qt::PenStyle style = Qt::SolidLine);
QImage to_image(const Raster& raster);

constexpr double small_text = 7.0, normal_text = 7.5;  // points

class Sheet {
 public:
  Sheet(double width_mm, double height_mm);
  ~Sheet();
  Sheet(const Sheet&) = delete;
  Sheet& operator=(const Sheet&) = delete;

  double width_mm() const { return width_mm_; }
  double height_mm() const { return height_mm_; }

  /// A panel whose inner rectangle has its top left corner at (x, y); thin left and bottom axes, ticks outward.
  QCPAxisRect* panel(double x_mm, double y_mm, double width_mm, double height_mm);
  /// Curves and points; the caller sets pen, brush and data.
  QCPGraph* graph(QCPAxisRect* panel);
  /// Paints below the axes, clipped to the panel. Panel coordinates by x_of, y_of.
  void paint(QCPAxisRect* panel, std::function<void(QCPPainter&)> painting);
  /// Paints above everything, on the whole sheet.
  void paint_over(std::function<void(QCPPainter&)> painting);
  /// `align` as in QPainter::drawText, about the point.
  void text(double x_mm, double y_mm, const QString& words, int align, double points = normal_text, bool bold = false,
            Rgb rgb = ink, double angle_deg = 0);

  /// Draws at the painter's origin, which must be scaled to sheet units.
  void draw(QCPPainter& painter) const;
  QImage image(double dots_per_inch) const;
  QByteArray png(double dots_per_inch) const;
  QByteArray svg() const;

 private:
  double width_mm_, height_mm_;
  std::unique_ptr<QCustomPlot> plot_;
  QCPLayoutInset* inset_ = nullptr;
};

inline double x_of(const QCPAxisRect* panel, double x) { return panel->axis(QCPAxis::atBottom)->coordToPixel(x); }
inline double y_of(const QCPAxisRect* panel, double y) { return panel->axis(QCPAxis::atLeft)->coordToPixel(y); }

/// Range, label ("x (m)") and number of ticks wanted.
void set_axis(QCPAxis* axis, double lower, double upper, const QString& label, int ticks = 5);
/// 1, 2 or 5 times a power of ten: nearest to range / count, so about `count` to the range.
double nice_step(double range, int count);
/// The greatest such number that is not above `length`.
double nice_length(double length);
/// Puts the ticks of an axis at multiples of `step`.
void set_step(QCPAxis* axis, double step);

/// A legend entry drawn by hand at (x, y), its text to the right; returns the x where the next may start, in mm.
enum class Key { line, dashed, dotted, dash_dot, band, disc, circle, square, triangle, cross, tile };
double draw_key(Sheet& sheet, double x_mm, double y_mm, Key key, Rgb rgb, const QString& words, double gap_mm = 5);

/// Width of words in mm.
double text_width(const QString& words, double points, bool bold = false);

}  // namespace pivnp::report

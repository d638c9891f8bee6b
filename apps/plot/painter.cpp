#include "apps/plot/painter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <QPainterPath>
#include <qcustomplot.h>

#include "apps/plot/qt.hpp"
#include "apps/plot/scatter.hpp"

namespace pivnp::plot {

namespace {

QPointF point(const Vec2& at) { return {at.x(), at.y()}; }
QRectF rectangle_of(const Rectangle& r) { return {r.left, r.top, r.width, r.height}; }

QPolygonF polygon_of(const std::vector<Vec2>& points) {
  QPolygonF polygon;
  for (const Vec2& at : points) polygon << point(at);
  return polygon;
}

}  // namespace

Rectangle between(const Vec2& one, const Vec2& other) {
  const Vec2 least = one.cwiseMin(other), size = (one - other).cwiseAbs();
  return {least.x(), least.y(), size.x(), size.y()};
}

int qt_alignment(Align align) {
  static constexpr std::array<int, 9> flags = {
      Qt::AlignLeft | Qt::AlignTop,     Qt::AlignHCenter | Qt::AlignTop,     Qt::AlignRight | Qt::AlignTop,
      Qt::AlignLeft | Qt::AlignVCenter, Qt::AlignHCenter | Qt::AlignVCenter, Qt::AlignRight | Qt::AlignVCenter,
      Qt::AlignLeft | Qt::AlignBottom,  Qt::AlignHCenter | Qt::AlignBottom,  Qt::AlignRight | Qt::AlignBottom};
  return flags[std::size_t(align)];
}

QCPScatterStyle scatter_style(const Symbol& symbol) {
  static constexpr std::array<QCPScatterStyle::ScatterShape, 11> shapes = {
      QCPScatterStyle::ssDisc,          QCPScatterStyle::ssCircle,           QCPScatterStyle::ssSquare,
      QCPScatterStyle::ssDiamond,       QCPScatterStyle::ssTriangle,         QCPScatterStyle::ssTriangleInverted,
      QCPScatterStyle::ssCross,         QCPScatterStyle::ssPlus,             QCPScatterStyle::ssStar,
      QCPScatterStyle::ssCrossSquare,   QCPScatterStyle::ssPlusCircle};
  return {shapes[std::size_t(symbol.marker)], qt_pen(symbol.pen), QBrush(qt_colour(symbol.fill.rgb, symbol.fill.alpha)),
          symbol.size_mm * units_per_mm};
}

void Painter::pen(const Pen& pen) { qt_.setPen(qt_pen(pen)); }
void Painter::fill(const Fill& fill) { qt_.setBrush(QBrush(qt_colour(fill.rgb, fill.alpha))); }
void Painter::no_pen() { qt_.setPen(QPen(Qt::NoPen)); }
void Painter::no_fill() { qt_.setBrush(QBrush(Qt::NoBrush)); }

void Painter::line(const Vec2& from, const Vec2& to) { qt_.drawLine(QLineF(point(from), point(to))); }
void Painter::polyline(const std::vector<Vec2>& points) { qt_.drawPolyline(polygon_of(points)); }
void Painter::polygon(const std::vector<Vec2>& points) { qt_.drawPolygon(polygon_of(points)); }

void Painter::rings(const std::vector<std::vector<Vec2>>& rings) {
  QPainterPath path;
  for (const std::vector<Vec2>& ring : rings) {
    QPolygonF polygon = polygon_of(ring);
    if (!polygon.isEmpty()) polygon << polygon.front();
    path.addPolygon(polygon);
  }
  qt_.drawPath(path);
}

void Painter::rectangle(const Rectangle& r) { qt_.drawRect(rectangle_of(r)); }
void Painter::ellipse(const Vec2& centre, double radius_x, double radius_y) {
  qt_.drawEllipse(point(centre), radius_x, radius_y);
}

void Painter::symbol(const Symbol& symbol, const Vec2& at) {
  const QCPScatterStyle style = scatter_style(symbol);
  style.applyTo(&qt_, qt_pen(symbol.pen));
  style.drawShape(&qt_, point(at));
}

void Painter::text(const Rectangle& r, const std::string& words, Align align, const TextStyle& style) {
  qt_.setFont(qt_font(style.points, style.bold));
  qt_.setPen(qt_colour(style.rgb));
  qt_.drawText(rectangle_of(r), qt_alignment(align), qt(words));
}

}  // namespace pivnp::plot

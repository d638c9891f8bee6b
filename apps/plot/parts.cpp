#include "apps/plot/parts.hpp"

#include "apps/plot/numbers.hpp"
#include "apps/report/words/words.hpp"

#include <algorithm>
#include <cmath>

#include "apps/report/content/analysis.hpp"

namespace pivnp::report {

Scale scale_for(const std::vector<double>& values, bool signed_values) {
  Scale s;
  const double least = quantile(values, 0), greatest = quantile(values, 1);
  if (!std::isfinite(least) || !std::isfinite(greatest)) {
    if (signed_values) s = {Colours::diverging, -1, 1};
    return s;
  }
  double low = quantile(values, 0.005), high = quantile(values, 0.995);
  if (least >= low - 0.05 * (high - low)) low = least;
  if (greatest <= high + 0.05 * (high - low)) high = greatest;
  if (signed_values || (least < 0 && greatest > 0)) {
    s.map = Colours::diverging;
    s.upper = std::max(std::abs(low), std::abs(high));
    s.lower = -s.upper;
  } else {
    s.lower = low > 0 && low < 0.7 * high ? 0 : low;
    s.upper = high < 0 && high > 0.7 * low ? 0 : high;
  }
  if (!(s.upper > s.lower)) {  // one value everywhere
    const double about = s.upper == 0 ? 1 : std::abs(s.upper) * 0.1;
    s.lower = s.map == Colours::diverging || s.upper != 0 ? s.upper - about : 0;
    s.upper += about;
  }
  const double slack = 1e-9 * (s.upper - s.lower);
  s.below = least < s.lower - slack;
  s.above = greatest > s.upper + slack;
  return s;
}

void colour_bar(Sheet& sheet, double x_mm, double y_mm, double width_mm, const Scale& scale, double factor,
                const QString& label) {
  constexpr double thickness = 2.6;
  QCPAxisRect* bar = sheet.panel(x_mm, y_mm, width_mm, thickness);
  QCPAxis* axis = bar->axis(QCPAxis::atBottom);
  set_axis(axis, scale.lower * factor, scale.upper * factor, label, 4);
  bar->axis(QCPAxis::atLeft)->setVisible(false);
  axis->setBasePen(Qt::NoPen);
  Raster strip{512, 1, {}};
  for (int k = 0; k < strip.width; ++k)
    strip.pixels.push_back(0xff000000u | colour_at(scale.map, (k + 0.5) / strip.width));
  const QImage image = to_image(strip);
  sheet.paint_over([=](QCPPainter& p) {
    const double x = x_mm * units_per_mm, y = y_mm * units_per_mm, w = width_mm * units_per_mm,
                 h = thickness * units_per_mm;
    p.setRenderHint(QPainter::SmoothPixmapTransform, false);
    p.drawImage(QRectF(x, y, w, h), image);
    QPolygonF outline;
    p.setPen(Qt::NoPen);
    outline << QPointF(x, y);
    if (scale.below) {
      p.setBrush(colour(colour_at(scale.map, 0)));
      p.drawPolygon(QPolygonF({{x, y}, {x - h, y + h / 2}, {x, y + h}}));
    }
    if (scale.above) {
      p.setBrush(colour(colour_at(scale.map, 1)));
      p.drawPolygon(QPolygonF({{x + w, y}, {x + w + h, y + h / 2}, {x + w, y + h}}));
    }
    outline << QPointF(x + w, y);
    if (scale.above) outline << QPointF(x + w + h, y + h / 2);
    outline << QPointF(x + w, y + h) << QPointF(x, y + h);
    if (scale.below) outline << QPointF(x - h, y + h / 2);
    p.setBrush(Qt::NoBrush);
    p.setPen(pen(ink, 0.5));
    p.drawPolygon(outline);
  });
}

QCPAxisRect* world_panel(Sheet& sheet, double x_mm, double y_mm, double width_mm, double height_mm, const Box& box,
                         const std::string& unit, bool label_x, bool label_y) {
  QCPAxisRect* panel = sheet.panel(x_mm, y_mm, width_mm, height_mm);
  QCPAxis *x = panel->axis(QCPAxis::atBottom), *y = panel->axis(QCPAxis::atLeft);
  // One tick distance for both axes, so that the eye can compare lengths.
  const double step =
      nice_step(std::max(box.width() / width_mm, box.height() / height_mm) * std::clamp(width_mm / 4, 12.0, 24.0), 1);
  set_axis(x, box.lower.x(), box.upper.x(), label_x ? axis_label("x", unit) : QString());
  set_axis(y, box.lower.y(), box.upper.y(), label_y ? axis_label("y", unit) : QString());
  for (QCPAxis* axis : {x, y}) set_step(axis, step);
  x->setTickLabels(label_x);
  y->setTickLabels(label_y);
  return panel;
}

void raster_in(Sheet& sheet, QCPAxisRect* panel, const QImage& image) {
  sheet.paint(panel, [=](QCPPainter& p) { p.drawImage(QRectF(panel->rect()), image); });
}

void band(Sheet& sheet, QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& lower,
          const std::vector<double>& upper, Rgb rgb, int alpha) {
  sheet.paint(panel, [=](QCPPainter& p) {
    p.setPen(Qt::NoPen);
    p.setBrush(colour(rgb, alpha));
    auto finite = [&](std::size_t k) { return std::isfinite(lower[k]) && std::isfinite(upper[k]); };
    for (std::size_t from = 0; from < x.size();) {
      std::size_t to = from;
      while (to < x.size() && finite(to)) ++to;
      if (to - from >= 2) {
        QPolygonF polygon;
        for (std::size_t k = from; k < to; ++k) polygon << QPointF(x_of(panel, x[k]), y_of(panel, upper[k]));
        for (std::size_t k = to; k-- > from;) polygon << QPointF(x_of(panel, x[k]), y_of(panel, lower[k]));
        p.drawPolygon(polygon);
      }
      from = std::max(to, from + 1);
    }
  });
}

QCPGraph* curve(Sheet& sheet, QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& y,
                const QPen& line) {
  QCPGraph* g = sheet.graph(panel);
  g->setPen(line);
  g->setData(QVector<double>(x.begin(), x.end()), QVector<double>(y.begin(), y.end()), true);
  return g;
}

void pale_grid(QCPAxisRect* panel) {
  QCPGrid* grid = panel->axis(QCPAxis::atLeft)->grid();
  grid->setVisible(true);
  grid->setPen(pen(0xe6e6e6, 0.4));
  grid->setZeroLinePen(pen(0xc4c4c4, 0.4));
}

void draw_scale_bar(Sheet& sheet, QCPAxisRect* panel, const Box& box, const std::string& unit) {
  const double length = nice_length(0.25 * box.width());
  const DisplayUnit shown = display_unit(unit, length);
  const QString label = qt(plain(length * shown.factor) + unit_suffix(shown.name));
  sheet.paint(panel, [=](QCPPainter& p) {
    const double w = x_of(panel, box.lower.x() + length) - x_of(panel, box.lower.x());
    const QRectF r(panel->rect());
    const double text = text_width(label, small_text) * units_per_mm, wide = std::max(w, text) + 40;
    const QRectF plate(r.right() - wide - 20, r.bottom() - 82, wide, 62);
    p.setPen(Qt::NoPen);
    p.setBrush(QColor(255, 255, 255, 225));
    p.drawRect(plate);
    p.setBrush(colour(ink));
    p.drawRect(QRectF(plate.center().x() - w / 2, plate.bottom() - 19, w, 7));
    p.setPen(colour(ink));
    p.setFont(font(small_text));
    p.drawText(QRectF(plate.left(), plate.top() + 3, plate.width(), 36), Qt::AlignCenter, label);
  });
}

}  // namespace pivnp::report

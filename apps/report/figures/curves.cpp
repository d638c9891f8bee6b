// Curves against time, and the outlines.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/plot/numbers.hpp"
#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/data_sets.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<Rgb, 3> point_colours = {blue, vermilion, green};
constexpr std::array<QCPScatterStyle::ScatterShape, 3> point_shapes = {
    QCPScatterStyle::ssCircle, QCPScatterStyle::ssSquare, QCPScatterStyle::ssTriangle};

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

double greatest(const std::vector<double>& values) { return quantile(values, 1); }

// Open markers, about forty to a curve at most.
QCPGraph* markers(Sheet& sheet, QCPAxisRect* panel, const std::vector<double>& x, const std::vector<double>& y,
                  QCPScatterStyle::ScatterShape shape, Rgb rgb) {
  std::vector<double> some_x, some_y;
  const std::size_t step = x.size() / 40 + 1;
  for (std::size_t k = 0; k < x.size(); k += step) {
    some_x.push_back(x[k]);
    some_y.push_back(y[k]);
  }
  QCPGraph* g = curve(sheet, panel, some_x, some_y, pen(rgb, 0.8));
  g->setLineStyle(QCPGraph::lsNone);
  g->setScatterStyle(QCPScatterStyle(shape, pen(rgb, 0.8), QBrush(Qt::white), 1.6 * units_per_mm));
  return g;
}

void draw_key_map(Sheet& sheet, const Content& content, const std::vector<Vec2>& points, double x, double y, double w,
                  double h) {
  const MotionSource& motion = content.measured ? *content.measured : *content.simulated;
  const ParticleSet& particles = motion.particles();
  Box box = box_around({&particles.x0}, 0);
  for (const Vec2& p : points) {
    box.lower = box.lower.cwiseMin(p);
    box.upper = box.upper.cwiseMax(p);
  }
  const double shrink = std::min(1.0, h / (w * box.height() / box.width()));
  const double width = w * shrink, height = width * box.height() / box.width();
  QCPAxisRect* panel = sheet.panel(x + (w - width) / 2, y, width, height);
  set_axis(panel->axis(QCPAxis::atBottom), box.lower.x(), box.upper.x(), "");
  set_axis(panel->axis(QCPAxis::atLeft), box.lower.y(), box.upper.y(), "");
  for (QCPAxis* axis : panel->axes()) axis->setVisible(false);
  std::vector<Tile> tiles;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double edge = p < particles.area.size() && particles.area[p] > 0
                            ? std::sqrt(particles.area[p])
                            : std::sqrt(box.width() * box.height() / double(particles.size()));
    tiles.push_back({particles.x0[p], Vec2(0.54 * edge, 0), Vec2(0, 0.54 * edge), 0xdcdcdc});
  }
  raster_in(sheet, panel, to_image(draw_tiles(tiles, box, int(width / 25.4 * 400))));
  sheet.paint_over([=](QCPPainter& p) {
    p.setFont(font(normal_text, true));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const QPointF at(x_of(panel, points[k].x()), y_of(panel, points[k].y()));
      const Rgb rgb = point_colours[k % 3];
      p.setPen(pen(0xffffff, 0.8));
      p.setBrush(colour(rgb));
      p.drawEllipse(at, 9, 9);
      p.setPen(colour(rgb));
      p.drawText(QRectF(at.x() - 60, at.y() - 46, 120, 36), Qt::AlignHCenter | Qt::AlignBottom,
                 QString(QChar('A' + int(k % 26))));
    }
  });
  sheet.text(x + w / 2, y + height + 2, "at the first frame", Qt::AlignHCenter | Qt::AlignTop, small_text, false,
             faint);
}

}  // namespace

std::optional<Figure> history_figure(const Content& content, const std::vector<Vec2>& points) {
  if (points.empty() || (!content.measured && !content.simulated)) return std::nullopt;
  std::vector<History> measured, simulated;
  if (content.measured) measured = histories(*content.measured, points);
  if (content.simulated) simulated = histories(*content.simulated, points);

  double top = 0, t0 = std::numeric_limits<double>::infinity(), t1 = -t0, greatest_sigma = 0;
  for (const auto* side : {&measured, &simulated})
    for (const History& h : *side) {
      for (std::size_t k = 0; k < h.time.size(); ++k) {
        t0 = std::min(t0, h.time[k]);
        t1 = std::max(t1, h.time[k]);
        const double sigma = h.sigma.empty() || !std::isfinite(h.sigma[k]) ? 0 : h.sigma[k];
        greatest_sigma = std::max(greatest_sigma, sigma);
        if (std::isfinite(h.displacement[k])) top = std::max(top, h.displacement[k] + 2 * sigma);
      }
    }
  const DisplayUnit unit = display_unit(content.length_unit, top);
  auto sheet = std::make_shared<Sheet>(figure_width_mm, 74);
  const double x = 15, y = 7, w = 103, h = 56;
  QCPAxisRect* panel = sheet->panel(x, y, w, h);
  pale_grid(panel);
  set_axis(panel->axis(QCPAxis::atBottom), t0 - 0.015 * (t1 - t0), t1 > t0 ? t1 + 0.03 * (t1 - t0) : t1,
           axis_label("time", content.time_unit), 6);
  set_axis(panel->axis(QCPAxis::atLeft), -0.025 * top * unit.factor, top > 0 ? 1.05 * top * unit.factor : 1,
           axis_label("displacement", unit.name), 6);

  std::string list;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Rgb rgb = point_colours[q % 3];
    if (q < simulated.size())
      curve(*sheet, panel, simulated[q].time, scaled(simulated[q].displacement, unit.factor),
            pen(rgb, 1.3, q < 3 ? Qt::SolidLine : Qt::DashLine));
    double label = nan_value;
    if (q < measured.size()) {
      const std::vector<double> d = scaled(measured[q].displacement, unit.factor);
      if (!measured[q].sigma.empty()) {
        std::vector<double> low, high;
        for (std::size_t k = 0; k < d.size(); ++k) {
          const double two = 2 * measured[q].sigma[k] * unit.factor;
          low.push_back(std::max(0.0, d[k] - two));
          high.push_back(d[k] + two);
        }
        band(*sheet, panel, measured[q].time, low, high, rgb, 70);
      }
      markers(*sheet, panel, measured[q].time, d, point_shapes[q % 3], rgb);
      for (double v : d)
        if (std::isfinite(v)) label = v;
    } else if (q < simulated.size()) {
      for (double v : simulated[q].displacement)
        if (std::isfinite(v)) label = v * unit.factor;
    }
    if (std::isfinite(label))
      sheet->paint_over([=](QCPPainter& p) {
        p.setFont(font(normal_text, true));
        p.setPen(colour(rgb));
        p.drawText(QRectF(panel->right() + 8, y_of(panel, label) - 20, 60, 40), Qt::AlignLeft | Qt::AlignVCenter,
                   QString(QChar('A' + int(q % 26))));
      });
    list += (q == 0                   ? ""
             : q + 1 == points.size() ? " and "
                                      : ", ") +
            std::string(1, char('A' + int(q % 26))) + " (" + plain(points[q].x()) + ", " + plain(points[q].y()) + ")";
  }
  double next = x;
  if (!measured.empty()) {
    next = draw_key(*sheet, next, 3, Key::circle, ink, qt(in_sides(content, "measured")), 3);
    if (greatest_sigma > 0)
      next = draw_key(*sheet, next, 3, Key::band, ink, qt(in_sides(content, "\u00b12\u03c3 of the measurement")));
  }
  if (!simulated.empty()) draw_key(*sheet, next, 3, Key::line, ink, qt(in_sides(content, "simulated")));
  draw_key_map(*sheet, content, points, 132, y, 36, 48);

  std::string caption =
      "Displacement of the material points " + list + unit_suffix(content.length_unit) + " against time";
  caption += !measured.empty() && !simulated.empty() ? ", measured (markers) and simulated (lines)."
             : measured.empty()                      ? ", simulated."
                                                     : ", measured.";
  if (greatest_sigma > 0) {
    caption += " The band is twice the measurement's standard uncertainty";
    if (greatest_sigma * 2 < 0.012 * top)
      caption += ", here at most " + number(2 * greatest_sigma * unit.factor, 2) + unit_suffix(unit.name) +
                 " and hardly wider than the markers";
    caption += ".";
  }
  caption += " A curve that stops: the point was followed no further.";
  return Figure{"histories", in_sides(content, caption), sheet};
}

std::optional<Figure> difference_figure(const Content& content, const DifferenceHistory& d) {
  if (d.time.size() < 2) return std::nullopt;
  const double largest = greatest(d.rms), sigma = greatest(d.sigma);
  if (!std::isfinite(largest)) return std::nullopt;
  const bool log = std::isfinite(sigma) && sigma > 0 && largest > 40 * sigma;
  const double top = std::max(largest, std::isfinite(sigma) ? sigma : 0);
  const DisplayUnit unit = display_unit(content.length_unit, top);
  auto positive = [&](std::vector<double> v) {
    for (double& f : v) f = log && !(f > 0) ? nan_value : f * unit.factor;
    return v;
  };
  const std::vector<double> rms = positive(d.rms), median = positive(d.median), own = positive(d.sigma);

  auto sheet = std::make_shared<Sheet>(figure_width_mm, 70);
  const double x = 17, y = 7, w = 150, h = 52;
  QCPAxisRect* panel = sheet->panel(x, y, w, h);
  pale_grid(panel);
  const double pad = 0.012 * (d.time.back() - d.time.front());
  set_axis(panel->axis(QCPAxis::atBottom), d.time.front() - pad, d.time.back() + pad,
           axis_label("time", content.time_unit), 8);
  QCPAxis* axis = panel->axis(QCPAxis::atLeft);
  set_axis(axis, 0, top > 0 ? 1.08 * top * unit.factor : 1, axis_label("displacement difference", unit.name), 5);
  if (log) {
    double least = quantile(own, 0);
    least = std::min(least, std::isfinite(quantile(median, 0.05)) ? quantile(median, 0.05) : least);
    axis->setScaleType(QCPAxis::stLogarithmic);
    const auto ticker = QSharedPointer<QCPAxisTickerLog>::create();
    axis->setTicker(ticker);
    axis->setRange(0.6 * least, 1.7 * top * unit.factor);
    axis->setNumberFormat("gb");
    axis->setNumberPrecision(1);
  }
  const std::vector<double> floor(own.size(), log ? axis->range().lower : 0.0);
  const bool known = std::isfinite(sigma) && sigma > 0;
  if (known) {
    band(*sheet, panel, d.time, floor, own, ink, 45);
    curve(*sheet, panel, d.time, own, pen(faint, 0.8, Qt::DotLine));
  }
  curve(*sheet, panel, d.time, median, pen(sky, 1.1, Qt::DashLine));
  curve(*sheet, panel, d.time, rms, pen(blue, 1.3));
  markers(*sheet, panel, d.time, rms, QCPScatterStyle::ssCircle, blue);
  double next = draw_key(*sheet, x, 3, Key::line, blue, "RMS");
  next = draw_key(*sheet, next, 3, Key::dashed, sky, "median");
  if (known)
    draw_key(*sheet, next, 3, Key::band, ink,
             qt(in_sides(content, "measurement\u2019s own standard uncertainty (RMS)")));
  std::string caption =
      "Difference of displacement, simulated minus measured, over the compared particles against time.";
  caption += known ? " Grey: what the measurement itself is uncertain by (random error, one standard deviation); a "
                     "difference inside it "
                     "has no meaning."
                   : " The measurement states no uncertainty.";
  if (log) caption += " Logarithmic scale.";
  return Figure{"difference", in_sides(content, caption), sheet};
}

std::optional<Figure> outline_figure(const Content& content) {
  if (!content.comparison) return std::nullopt;
  const auto& [first, second] = content.comparison->outlines;
  if (first.empty() && second.empty()) return std::nullopt;
  std::vector<const std::vector<Vec2>*> all;
  for (const auto& outline : content.comparison->outlines)
    for (const auto& loop : outline) all.push_back(&loop);
  const Box box = box_around(all, 0);
  const double aspect = box.height() / box.width(), left = 15, head = 7, foot = 11;
  const double w = std::min(120.0, 80 / aspect), h = w * aspect, x = left + (figure_width_mm - left - 5 - w) / 2;
  auto sheet = std::make_shared<Sheet>(figure_width_mm, head + h + foot);
  QCPAxisRect* panel = world_panel(*sheet, x, head, w, h, box, content.length_unit, true, true);
  auto path = [panel](const std::vector<std::vector<Vec2>>& loops) {
    QPainterPath p;
    for (const auto& loop : loops) {
      QPolygonF polygon;
      for (const Vec2& v : loop) polygon << QPointF(x_of(panel, v.x()), y_of(panel, v.y()));
      if (!polygon.isEmpty()) polygon << polygon.front();
      p.addPolygon(polygon);
    }
    return p;
  };
  sheet->paint(panel, [=, first = first, second = second](QCPPainter& p) {
    p.setPen(pen(ink, 1.2));
    p.setBrush(QColor(0xe4, 0xe4, 0xe4));
    p.drawPath(path(first));
    p.setPen(pen(vermilion, 1.2, Qt::DashLine));
    p.setBrush(Qt::NoBrush);
    p.drawPath(path(second));
  });
  double next = draw_key(*sheet, x, 3, Key::line, ink, qt(in_sides(content, "measured")));
  draw_key(*sheet, next, 3, Key::dashed, vermilion, qt(in_sides(content, "simulated")));
  return Figure{
      "outline",
      in_sides(content, "Outline of the material at the last compared time: measured (filled) and simulated (dashed)."),
      sheet};
}

std::optional<Figure> energy_figure(const Content& content) {
  if (content.energy.size() < 2) return std::nullopt;
  struct Term {
    const char* words;
    double EnergyRow::*value;
    Rgb rgb;
    Qt::PenStyle line;
    Key key;
  };
  static const std::array<Term, 6> terms = {
      {{"kinetic", &EnergyRow::kinetic, blue, Qt::SolidLine, Key::line},
       {"elastic", &EnergyRow::elastic, green, Qt::DashLine, Key::dashed},
       {"plastic dissipation", &EnergyRow::plastic, vermilion, Qt::SolidLine, Key::line},
       {"damping", &EnergyRow::damping, purple, Qt::DashDotLine, Key::dash_dot},
       {"friction at contacts", &EnergyRow::contact, orange, Qt::DashLine, Key::dashed},
       {"external work", &EnergyRow::external, ink, Qt::DotLine, Key::dotted}}};
  std::vector<double> time, residual;
  double low = 0, high = 0;
  for (const EnergyRow& row : content.energy) {
    time.push_back(row.time);
    residual.push_back(row.residual);
    for (const Term& t : terms)
      if (std::isfinite(row.*t.value)) {
        low = std::min(low, row.*t.value);
        high = std::max(high, row.*t.value);
      }
  }
  const double size = std::max(high, -low), share = size > 0 ? 100 / size : 0;
  auto sheet = std::make_shared<Sheet>(figure_width_mm, 84);
  const double x = 17, w = 108, margin = high > low ? 0.04 * (high - low) : 1;
  QCPAxisRect* upper = sheet->panel(x, 5, w, 42);
  QCPAxisRect* lower = sheet->panel(x, 53, w, 20);
  for (QCPAxisRect* panel : {upper, lower}) {
    pale_grid(panel);
    set_axis(panel->axis(QCPAxis::atBottom), time.front(), time.back(),
             panel == lower ? axis_label("time", content.time_unit) : QString(), 6);
    panel->axis(QCPAxis::atBottom)->setTickLabels(panel == lower);
  }
  set_axis(upper->axis(QCPAxis::atLeft), low - (low < 0 ? margin : 0), high + margin, "energy (J/m)", 5);
  double least = 0, most = 0;
  for (double& r : residual) {
    r *= share;
    if (std::isfinite(r)) least = std::min(least, r), most = std::max(most, r);
  }
  const double spread = most > least ? 0.15 * (most - least) : 1;
  set_axis(lower->axis(QCPAxis::atLeft), least - spread, most + spread, "residual (%)", 3);
  double key_y = 9;
  for (const Term& t : terms) {
    std::vector<double> value;
    for (const EnergyRow& row : content.energy) value.push_back(row.*t.value);
    if (std::all_of(value.begin(), value.end(), [&](double v) { return !(std::abs(v) > 1e-6 * size); })) continue;
    curve(*sheet, upper, time, value, pen(t.rgb, 1.2, t.line));
    draw_key(*sheet, x + w + 5, key_y, t.key, t.rgb, t.words);
    key_y += 5;
  }
  curve(*sheet, lower, time, residual, pen(ink, 1.1));
  sheet->text(x - 15, 2, "(a)", Qt::AlignLeft | Qt::AlignTop, normal_text, true);
  sheet->text(x - 15, 50, "(b)", Qt::AlignLeft | Qt::AlignTop, normal_text, true);
  const double final_share = residual.back();
  return Figure{"energy",
                "Energy of the simulation, per metre of thickness: (a) its terms (those that stay zero are left out); "
                "(b) the residual, "
                "what the scheme gained (+) or lost (\u2212), in per cent of the largest term; at the end " +
                    (std::isfinite(final_share) ? number(final_share, 2) + " %." : std::string("not known.")),
                sheet};
}

}  // namespace pivnp::report

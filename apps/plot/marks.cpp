#include "apps/plot/marks.hpp"

#include <algorithm>
#include <cmath>

#include "apps/plot/numbers.hpp"

namespace pivnp::plot {

std::string axis_label(const std::string& what, const std::string& unit) {
  return unit_suffix(unit).empty() ? what : what + " (" + unit + ")";
}

void colour_bar(Canvas& canvas, double x_mm, double y_mm, double width_mm, const Scale& scale, double factor,
                const std::string& label) {
  constexpr double thickness = 2.6;
  Panel bar = canvas.panel(x_mm, y_mm, width_mm, thickness);
  bar.axis(Axis::x, scale.lower * factor, scale.upper * factor, label, 4).base_line(Axis::x, false);
  bar.visible(Axis::y, false);
  Raster strip{512, 1, {}};
  for (int k = 0; k < strip.width; ++k)
    strip.pixels.push_back(0xff000000u | colour_at(scale.map, (k + 0.5) / strip.width));
  canvas.raster_over(x_mm, y_mm, width_mm, thickness, strip);
  canvas.paint_over([=](Painter& p) {
    const double x = x_mm * units_per_mm, y = y_mm * units_per_mm, w = width_mm * units_per_mm,
                 h = thickness * units_per_mm;
    const Vec2 before(x - h, y + h / 2), beyond(x + w + h, y + h / 2);
    p.no_pen();
    if (scale.below) {
      p.fill({colour_at(scale.map, 0)});
      p.polygon({{x, y}, before, {x, y + h}});
    }
    if (scale.above) {
      p.fill({colour_at(scale.map, 1)});
      p.polygon({{x + w, y}, beyond, {x + w, y + h}});
    }
    std::vector<Vec2> outline = {{x, y}, {x + w, y}};
    if (scale.above) outline.push_back(beyond);
    outline.emplace_back(x + w, y + h);
    outline.emplace_back(x, y + h);
    if (scale.below) outline.push_back(before);
    p.no_fill();
    p.pen({});
    p.polygon(outline);
  });
}

Panel world_panel(Canvas& canvas, double x_mm, double y_mm, double width_mm, double height_mm, const Box& box,
                  const std::string& unit, bool label_x, bool label_y) {
  Panel panel = canvas.panel(x_mm, y_mm, width_mm, height_mm);
  // One tick distance for both axes, so that the eye can compare lengths.
  double step =
      nice_step(std::max(box.width() / width_mm, box.height() / height_mm) * std::clamp(width_mm / 4, 12.0, 24.0), 1);
  step = std::min(step_with_ticks(box.lower.x(), box.upper.x(), step), step_with_ticks(box.lower.y(), box.upper.y(), step));
  panel.axis(Axis::x, box.lower.x(), box.upper.x(), label_x ? axis_label("x", unit) : "");
  panel.axis(Axis::y, box.lower.y(), box.upper.y(), label_y ? axis_label("y", unit) : "");
  panel.step(Axis::x, step).numbers(Axis::x, label_x);
  panel.step(Axis::y, step).numbers(Axis::y, label_y);
  return panel;
}

void scale_bar(Canvas& canvas, double right_mm, double y_mm, const Panel& panel, const Box& box, const std::string& unit) {
  const double length = nice_length(0.25 * box.width());
  const DisplayUnit shown = display_unit(unit, length);
  const std::string label = plain(length * shown.factor) + unit_suffix(shown.name);
  canvas.text(right_mm, y_mm, label, Align::right, {.points = small_text});
  const double end = (right_mm - text_width(label, small_text) - 1.5) * units_per_mm, y = y_mm * units_per_mm;
  canvas.paint_over([=](Painter& p) {
    const double w = panel.x(box.lower.x() + length) - panel.x(box.lower.x());
    p.no_pen();
    p.fill({ink});
    p.rectangle({end - w, y - 3.5, w, 7});
    for (const double at : {end - w, end}) p.rectangle({at - 1.5, y - 9, 3, 18});
  });
}

void band(Canvas& canvas, const Panel& panel, const std::vector<double>& x, const std::vector<double>& lower,
          const std::vector<double>& upper, const Fill& fill) {
  canvas.paint(panel, [=](Painter& p) {
    p.no_pen();
    p.fill(fill);
    const auto finite = [&](std::size_t k) { return std::isfinite(lower[k]) && std::isfinite(upper[k]); };
    for (std::size_t from = 0; from < x.size();) {
      std::size_t to = from;
      while (to < x.size() && finite(to)) ++to;
      if (to - from >= 2) {
        std::vector<Vec2> polygon;
        for (std::size_t k = from; k < to; ++k) polygon.push_back(panel.at({x[k], upper[k]}));
        for (std::size_t k = to; k-- > from;) polygon.push_back(panel.at({x[k], lower[k]}));
        p.polygon(polygon);
      }
      from = std::max(to, from + 1);
    }
  });
}

void markers(Canvas& canvas, const Panel& panel, const std::vector<double>& x, const std::vector<double>& y,
             Marker marker, Rgb rgb) {
  std::vector<double> some_x, some_y;
  const std::size_t step = x.size() / 40 + 1;
  for (std::size_t k = 0; k < x.size(); k += step) {
    some_x.push_back(x[k]);
    some_y.push_back(y[k]);
  }
  canvas.points(panel, some_x, some_y, {.marker = marker, .pen = {rgb, 0.8}, .size_mm = 1.6});
}

void arrow(Painter& p, const Vec2& tail, const Vec2& tip, Rgb rgb) {
  const Vec2 d = tip - tail;
  const double length = std::hypot(d.x(), d.y());
  if (!std::isfinite(length)) return;
  if (length < 3) {
    p.no_pen();
    p.fill({rgb});
    p.ellipse((tail + tip) / 2, 1.8, 1.8);
    return;
  }
  const double head = std::min(11.0, 0.45 * length), half = 0.36 * head;
  const Vec2 e = d / length, n(-e.y(), e.x()), neck = tip - head * e;
  for (const bool halo : {true, false}) {
    p.pen(halo ? Pen{0xffffff, 1.5} : Pen{rgb, 0.75});
    p.line(tail, neck);
    if (halo) p.pen({0xffffff, 0.7});
    else p.no_pen();
    p.fill({halo ? 0xffffff : rgb});
    p.polygon({tip, neck + half * n, neck - half * n});
  }
}

double legend(Canvas& canvas, double x_mm, double y_mm, Key key, Rgb rgb, const std::string& words, double gap_mm) {
  const bool wide =
      key == Key::line || key == Key::dashed || key == Key::dotted || key == Key::dash_dot || key == Key::band;
  const double width = wide ? 7 : 2.4;
  canvas.paint_over([=](Painter& p) {
    const double x = x_mm * units_per_mm, y = y_mm * units_per_mm, w = width * units_per_mm;
    const double r = 0.9 * units_per_mm;
    const Vec2 c(x + w / 2, y);
    const auto line = [&](Dash dash) {
      p.pen({rgb, 1.1, dash});
      p.line({x, y}, {x + w, y});
    };
    p.pen({rgb, 1.1});
    p.no_fill();
    switch (key) {
      case Key::line: line(Dash::solid); break;
      case Key::dashed: line(Dash::dashed); break;
      case Key::dotted: line(Dash::dotted); break;
      case Key::dash_dot: line(Dash::dash_dot); break;
      case Key::band:
        p.no_pen();
        p.fill({rgb, 60});
        p.rectangle({x, y - 1.1 * r, w, 2.2 * r});
        break;
      case Key::disc:
        p.no_pen();
        p.fill({rgb});
        p.ellipse(c, r, r);
        break;
      case Key::circle: p.ellipse(c, r, r); break;
      case Key::square: p.rectangle({c.x() - r, y - r, 2 * r, 2 * r}); break;
      case Key::triangle: p.polygon({c + Vec2(-r, r), c + Vec2(r, r), c - Vec2(0, r)}); break;
      case Key::cross:
        p.line(c - Vec2(r, r), c + Vec2(r, r));
        p.line(c + Vec2(-r, r), c + Vec2(r, -r));
        break;
      case Key::tile:
        p.pen({faint, 0.3});
        p.fill({rgb});
        p.rectangle({x, y - 1.2 * r, w, 2.4 * r});
        break;
    }
  });
  canvas.text(x_mm + width + 1.3, y_mm, words, Align::left, {.points = small_text});
  return x_mm + width + 1.3 + text_width(words, small_text) + gap_mm;
}

}  // namespace pivnp::plot

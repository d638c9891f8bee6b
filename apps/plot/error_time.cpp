#include "apps/plot/error_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pivnp::plot {

namespace {

constexpr std::array<Marker, 9> other_markers = {Marker::square, Marker::diamond, Marker::triangle,
                                                 Marker::triangle_down, Marker::cross, Marker::plus,
                                                 Marker::star, Marker::cross_square, Marker::plus_circle};
constexpr std::array<Rgb, 8> own_colours = {vermilion, blue, red, green, purple, orange, sky, ink};
constexpr Rgb pale = 0xe4e4e4;

void draw_decades(Canvas& canvas, const Panel& panel, const ErrorTimeChart& chart) {
  canvas.paint(panel, [=](Painter& p) {
    p.pen({pale, 0.5});
    for (double e = std::pow(10, std::floor(std::log10(chart.least) + 1e-9) + 1); e < 0.99 * chart.greatest; e *= 10)
      p.line(panel.at({chart.quickest, e}), panel.at({chart.slowest, e}));
  });
}

// What is asked for, and from each point up to its worst.
void draw_spreads(Canvas& canvas, const Panel& panel, const ErrorTimeChart& chart) {
  canvas.paint(panel, [=](Painter& p) {
    p.pen({faint, 0.8});
    if (chart.asked) p.line(panel.at({chart.quickest, *chart.asked}), panel.at({chart.slowest, *chart.asked}));
    for (const ErrorTimePoint& point : chart.points) {
      if (!std::isfinite(point.worst)) continue;
      Pen pen{point.symbol.pen.rgb, 0.7};
      pen.alpha = 110;
      p.pen(pen);
      const Vec2 low = panel.at({point.time, point.error});
      const Vec2 high(low.x(), panel.y(std::min(point.worst, chart.greatest))), half(0.8 * units_per_mm, 0);
      p.line(low, high);
      p.line(high - half, high + half);
    }
  });
}

void draw_front(Canvas& canvas, const Panel& panel, const ErrorTimeChart& chart) {
  const std::vector<ErrorTimePoint> best = front(chart.points);
  if (best.empty()) return;
  canvas.paint(panel, [=](Painter& p) {
    p.pen({ink, 0.6, Dash::dashed});
    std::vector<Vec2> path = {panel.at({best.front().time, chart.greatest})};
    for (std::size_t n = 0; n < best.size(); ++n) {
      path.push_back(panel.at({best[n].time, best[n].error}));
      path.push_back(panel.at({n + 1 < best.size() ? best[n + 1].time : chart.slowest, best[n].error}));
    }
    p.polyline(path);
  });
}

struct Patch {
  double x, y, width, height;  // mm
  bool meets(const Patch& o) const {
    return x < o.x + o.width && o.x < x + width && y < o.y + o.height && o.y < y + height;
  }
  bool holds(const Patch& o) const { return o.x >= x && o.x + o.width <= x + width && o.y >= y && o.y + o.height <= y + height; }
};

// Places for a name about a symbol, the best first: beside it, and then on ever wider rings.
std::vector<Patch> places_about(const Patch& at, double wide, double line, bool own) {
  const double cx = at.x + at.width / 2, cy = at.y + at.height / 2, off = at.width / 2 + 0.8;
  const double right = cx + off, left = cx - off - wide, above = cy - line - 0.5, below = cy + 0.5;
  // One's own, whose front is a line to the right, above that.
  std::vector<Patch> all = {{right, own ? above : cy - line / 2, wide, line},
                            {left, cy - line / 2, wide, line},
                            {right, below + 0.4, wide, line},
                            {cx - wide / 2, cy + off, wide, line},
                            {cx - wide / 2, cy - off - line, wide, line},
                            {left, below, wide, line},
                            {left, above, wide, line},
                            {right, cy + off, wide, line}};
  constexpr int rings = 8, angles = 16;
  for (int ring = 1; ring <= rings; ++ring)
    for (int k = 0; k < angles; ++k) {
      const double angle = 2 * M_PI * (k + 0.5) / angles, x = cx + (off + 1.5 * line * ring) * std::cos(angle), y = cy + (off + line * ring) * std::sin(angle);
      all.push_back({std::cos(angle) < 0 ? x - wide : x, y - line / 2, wide, line});
    }
  return all;
}
constexpr std::size_t beside = 8;  // of places_about

// From a name that had to go far to its symbol.
void draw_leader(Canvas& canvas, const Patch& symbol, const Patch& name) {
  const Vec2 from(symbol.x + symbol.width / 2, symbol.y + symbol.height / 2);
  const Vec2 to(std::clamp(from.x(), name.x, name.x + name.width), std::clamp(from.y(), name.y, name.y + name.height));
  canvas.paint_over([=](Painter& p) {
    p.pen({faint, 0.4});
    p.line(from * units_per_mm, to * units_per_mm);
  });
}

// Names where nothing is in the way, one's own first; `symbols`: the patches that the points take. A name for which there is no place is left out.
void draw_names(Canvas& canvas, const Patch& frame, const std::vector<ErrorTimePoint>& points, const std::vector<Patch>& symbols) {
  std::vector<Patch> taken = symbols;
  constexpr double line = 3.1;
  std::vector<std::size_t> order;
  for (const bool own : {true, false})
    for (std::size_t k = 0; k < points.size(); ++k)
      if (points[k].own == own && !points[k].name.empty()) order.push_back(k);
  for (const std::size_t k : order) {
    const ErrorTimePoint& point = points[k];
    const double wide = text_width(point.name, small_text, point.own);
    const std::vector<Patch> tries = places_about(symbols[k], wide, line, point.own);
    const auto free = std::find_if(tries.begin(), tries.end(), [&](const Patch& t) {
      return frame.holds(t) && std::none_of(taken.begin(), taken.end(), [&](const Patch& o) { return t.meets(o); });
    });
    if (free == tries.end()) continue;
    taken.push_back(*free);
    if (std::size_t(free - tries.begin()) >= beside) draw_leader(canvas, symbols[k], *free);
    canvas.text(free->x, free->y + line / 2, point.name, Align::left,
                {.points = small_text, .bold = point.own, .rgb = point.own ? point.symbol.pen.rgb : faint});
  }
}

double share_of(double value, double lower, double upper) { return std::log(value / lower) / std::log(upper / lower); }

}  // namespace

std::vector<Symbol> entry_symbols(const std::vector<bool>& own, double size_mm) {
  std::vector<Symbol> symbols;
  std::size_t others = 0;
  for (std::size_t k = 0; k < own.size(); ++k) {
    const Rgb rgb = own_colours[k % own_colours.size()];
    if (own[k]) symbols.push_back({Marker::disc, {rgb, 0.9}, {rgb}, size_mm});
    else symbols.push_back({other_markers[others++ % other_markers.size()], {faint, 0.9}, {0xffffff}, size_mm});
  }
  return symbols;
}

std::vector<ErrorTimePoint> front(std::vector<ErrorTimePoint> points) {
  std::sort(points.begin(), points.end(),
            [](const ErrorTimePoint& a, const ErrorTimePoint& b) { return a.time < b.time; });
  std::vector<ErrorTimePoint> best;
  for (ErrorTimePoint& p : points)
    if (best.empty() || p.error < best.back().error) best.push_back(std::move(p));
  return best;
}

void draw_error_time(Canvas& canvas, double x_mm, double y_mm, double width_mm, double height_mm,
                     const ErrorTimeChart& given) {
  ErrorTimeChart chart = given;
  std::erase_if(chart.points, [](const ErrorTimePoint& p) { return !std::isfinite(p.time) || !std::isfinite(p.error); });
  Panel panel = canvas.panel(x_mm, y_mm, width_mm, height_mm);
  panel.axis(Axis::x, chart.quickest, chart.slowest, chart.time_label);
  panel.axis(Axis::y, chart.least, chart.greatest, chart.error_label);
  panel.logarithmic(Axis::x, chart.quickest, chart.slowest, 5).small_ticks(Axis::x);
  panel.logarithmic(Axis::y, chart.least, chart.greatest, 5).small_ticks(Axis::y);
  panel.numbers(Axis::x, chart.time_numbers).numbers(Axis::y, chart.error_numbers);
  draw_decades(canvas, panel, chart);
  draw_spreads(canvas, panel, chart);
  draw_front(canvas, panel, chart);
  canvas.paint_over([=](Painter& painter) {
    for (auto p = chart.points.rbegin(); p != chart.points.rend(); ++p)  // the first on top
      painter.symbol(p->symbol, panel.at({p->time, p->error}));
  });
  if (!chart.names) return;
  std::vector<Patch> symbols;
  for (const ErrorTimePoint& p : chart.points) {
    constexpr double half = 1.6;
    const double x = x_mm + share_of(p.time, chart.quickest, chart.slowest) * width_mm;
    const double y = y_mm + (1 - share_of(p.error, chart.least, chart.greatest)) * height_mm;
    symbols.push_back({x - half, y - half, 2 * half, 2 * half});
  }
  draw_names(canvas, {x_mm, y_mm, width_mm, height_mm}, chart.points, symbols);
}

}  // namespace pivnp::plot

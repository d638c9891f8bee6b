// Displacement of material points against time, and where they are; and the pressure of their water.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/content/point_curves.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/figures/points.hpp"
#include "apps/report/figures/rows.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

void draw_key_map(Canvas& canvas, const Content& content, const std::vector<Vec2>& points, double x, double y, double w,
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
  Panel panel = canvas.panel(x + (w - width) / 2, y, width, height);
  panel.axis(Axis::x, box.lower.x(), box.upper.x(), "").visible(Axis::x, false);
  panel.axis(Axis::y, box.lower.y(), box.upper.y(), "").visible(Axis::y, false);
  std::vector<Tile> tiles;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const double known = particle_spacing(particles, p);
    const double edge = known > 0 ? known : std::sqrt(box.width() * box.height() / double(particles.size()));
    tiles.push_back({particles.x0[p], Vec2(0.54 * edge, 0), Vec2(0, 0.54 * edge), 0xdcdcdc});
  }
  canvas.raster(panel, draw_tiles(tiles, box, int(width / 25.4 * 400)));
  canvas.paint_over([=](Painter& p) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 at = panel.at(points[k]);
      const Rgb rgb = point_colours[k % 3];
      p.pen({0xffffff, 0.8});
      p.fill({rgb});
      p.ellipse(at, 9, 9);
      p.text({at.x() - 60, at.y() - 46, 120, 36}, letter_of(k), Align::bottom, {.bold = true, .rgb = rgb});
    }
  });
  canvas.text(x + w / 2, y + height + 2, "at the first frame", Align::top, {.points = small_text, .rgb = faint});
}

// What the curves of both data sets cover.
struct Extent {
  double top = 0, first = std::numeric_limits<double>::infinity(), last = -first, sigma = 0;
};

Extent extent_of(const std::vector<PointCurve>& one, const std::vector<PointCurve>& other) {
  Extent e;
  for (const auto* curves : {&one, &other})
    for (const PointCurve& c : *curves)
      for (std::size_t k = 0; k < c.time.size(); ++k) {
        e.first = std::min(e.first, c.time[k]);
        e.last = std::max(e.last, c.time[k]);
        const double sigma = c.sigma.empty() || !std::isfinite(c.sigma[k]) ? 0 : c.sigma[k];
        e.sigma = std::max(e.sigma, sigma);
        if (std::isfinite(c.displacement[k])) e.top = std::max(e.top, c.displacement[k] + 2 * sigma);
      }
  return e;
}

double last_known(const std::vector<double>& values) {
  double found = nan_value;
  for (const double v : values)
    if (std::isfinite(v)) found = v;
  return found;
}

void draw_uncertainty(Canvas& canvas, const Panel& panel, const PointCurve& curve, double factor, Rgb rgb) {
  std::vector<double> low, high;
  for (std::size_t k = 0; k < curve.time.size(); ++k) {
    const double d = curve.displacement[k] * factor, two = 2 * curve.sigma[k] * factor;
    low.push_back(std::max(0.0, d - two));
    high.push_back(d + two);
  }
  band(canvas, panel, curve.time, low, high, {rgb, 70});
}

// Letters at the curves' ends, moved apart where curves end close together.
void draw_letters(Canvas& canvas, const Panel& panel, const std::vector<double>& ends) {
  canvas.paint_over([=](Painter& p) {
    constexpr double line = 30;
    std::vector<std::size_t> order;
    for (std::size_t q = 0; q < ends.size(); ++q)
      if (std::isfinite(ends[q])) order.push_back(q);
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ends[a] < ends[b]; });
    double last = std::numeric_limits<double>::infinity();
    for (const std::size_t q : order) {
      last = std::min(panel.y(ends[q]), last - line);
      p.text({panel.frame().right() + 7, last - 20, 60, 40}, letter_of(q), Align::left,
             {.bold = true, .rgb = point_colours[q % 3]});
    }
  });
}

std::string caption(const FigureInput& input, const Extent& extent, const DisplayUnit& unit) {
  const Content& content = input.content;
  const DataSetNames& names = input.names;
  std::string text = "Displacement of the material points ";
  const std::size_t n = input.points.size();
  for (std::size_t q = 0; q < n; ++q)
    text += (q == 0 ? "" : q + 1 == n ? " and " : ", ") + letter_of(q) + " (" + plain(input.points[q].x()) + ", " +
            plain(input.points[q].y()) + ")";
  text += unit_suffix(content.length_unit) + " against time, ";
  if (content.measured && content.simulated) text += names.first + " (markers) and " + names.second + " (lines).";
  else text += (content.measured ? names.first : names.second) + ".";
  if (extent.sigma > 0) {
    text += " The band is twice " + names.the_first + "\u2019s standard uncertainty";
    if (extent.sigma * 2 < 0.012 * extent.top)
      text += ", here at most " + significant(2 * extent.sigma * unit.factor, 2) + unit_suffix(unit.name) +
              " and hardly wider than the markers";
    text += ".";
  }
  if (!content.alignment.empty()) text += " " + content.alignment;
  return text + " Where a curve stops, its point was followed no further.";
}

std::vector<Figure> draw_point_curves(const FigureInput& input) {
  const Content& content = input.content;
  const std::vector<Vec2>& points = input.points;
  std::vector<PointCurve> measured, simulated;
  if (content.measured) measured = point_curves(*content.measured, points);
  if (content.simulated) simulated = point_curves(*content.simulated, points);
  const Extent extent = extent_of(measured, simulated);
  const double top = extent.top, span = extent.last - extent.first;
  const DisplayUnit unit = display_unit(content.length_unit, top);

  auto canvas = std::make_shared<Canvas>(figure_width_mm, 64);
  const double x = 15, y = 7, w = 103, h = 46;
  Panel panel = canvas->panel(x, y, w, h);
  panel.pale_grid();
  panel.axis(Axis::x, extent.first - 0.015 * span, span > 0 ? extent.last + 0.03 * span : extent.last,
             axis_label("time", content.time_unit), 6);
  panel.axis(Axis::y, -0.025 * top * unit.factor, top > 0 ? 1.05 * top * unit.factor : 1,
             axis_label("displacement", unit.name), 6);
  std::vector<double> ends;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Rgb rgb = point_colours[q % 3];
    double label = nan_value;
    if (q < simulated.size()) {
      const std::vector<double> d = scaled(simulated[q].displacement, unit.factor);
      canvas->curve(panel, simulated[q].time, d, {rgb, 1.3, q < 3 ? Dash::solid : Dash::dashed});
      label = last_known(d);
    }
    if (q < measured.size()) {
      const std::vector<double> d = scaled(measured[q].displacement, unit.factor);
      if (!measured[q].sigma.empty()) draw_uncertainty(*canvas, panel, measured[q], unit.factor, rgb);
      markers(*canvas, panel, measured[q].time, d, point_markers[q % 3], rgb);
      label = last_known(d);
    }
    ends.push_back(label);
  }
  draw_letters(*canvas, panel, ends);
  double next = x;
  if (!measured.empty()) {
    next = legend(*canvas, next, 3, Key::circle, ink, input.names.first, 3);
    if (extent.sigma > 0)
      next = legend(*canvas, next, 3, Key::band, ink, "\u00b12\u03c3 of " + input.names.the_first);
  }
  if (!simulated.empty()) legend(*canvas, next, 3, Key::line, ink, input.names.second);
  draw_key_map(*canvas, content, points, 132, y, 36, 40);
  std::vector<ComparisonTable::Column> data;
  for (const auto& [curves, who] : {std::pair{&measured, input.names.first}, {&simulated, input.names.second}})
    for (std::size_t q = 0; q < curves->size(); ++q) {
      const PointCurve& c = (*curves)[q];
      data.push_back({who + " " + letter_of(q) + ", time", content.time_unit, c.time});
      data.push_back({who + " " + letter_of(q) + ", displacement", content.length_unit, c.displacement});
      if (!c.sigma.empty()) data.push_back({who + " " + letter_of(q) + ", standard uncertainty", content.length_unit, c.sigma});
    }
  return {{caption(input, extent, unit), canvas, {}, {}, std::move(data)}};
}

bool knows_pressure(const MotionSource* motion) { return motion && !motion->times().empty() && motion->frame(0).find("pressure"); }

bool has_pressure(const FigureInput& input) {
  return !input.points.empty() && (knows_pressure(input.content.measured.get()) || knows_pressure(input.content.simulated.get()));
}

std::vector<Figure> draw_point_pressures(const FigureInput& input) {
  const Content& content = input.content;
  const DataSetNames& who = input.names;
  std::vector<PointCurve> first, second;
  if (knows_pressure(content.measured.get())) first = point_curves(*content.measured, input.points);
  if (knows_pressure(content.simulated.get())) second = point_curves(*content.simulated, input.points);
  double low = 0, high = 0, begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const auto* curves : {&first, &second})
    for (const PointCurve& c : *curves) {
      begin = std::min(begin, c.time.front());
      end = std::max(end, c.time.back());
      for (const double p : c.pressure)
        if (std::isfinite(p)) low = std::min(low, p), high = std::max(high, p);
    }
  const DisplayUnit unit = display_unit("Pa", std::max(high, -low));
  const double margin = high > low ? 0.04 * (high - low) : 1, span = end - begin;
  auto canvas = std::make_shared<Canvas>(figure_width_mm, 74);
  const double x = 15, y = 7, w = 103, h = 56;
  Panel panel = canvas->panel(x, y, w, h);
  panel.pale_grid();
  panel.axis(Axis::x, begin - 0.015 * span, end + 0.03 * span, axis_label("time", content.time_unit), 6);
  panel.axis(Axis::y, (low - margin) * unit.factor, (high + margin) * unit.factor, axis_label("pore pressure", unit.name), 6);
  const bool both = !first.empty() && !second.empty();
  std::vector<double> ends(input.points.size(), nan_value);
  std::vector<ComparisonTable::Column> data;
  std::string names;
  for (std::size_t q = 0; q < input.points.size(); ++q) {
    const Rgb rgb = point_colours[q % 3];
    const auto add = [&](const std::vector<PointCurve>& curves, const std::string& name, bool with_markers) {
      if (curves.empty()) return;
      const PointCurve& c = curves[q];
      const std::vector<double> p = scaled(c.pressure, unit.factor);
      if (with_markers) markers(*canvas, panel, c.time, p, point_markers[q % 3], rgb);
      else canvas->curve(panel, c.time, p, {rgb, 1.3, q < 3 ? Dash::solid : Dash::dashed});
      ends[q] = last_known(p);
      const std::string of = (both ? name + " " : "") + letter_of(q);
      data.push_back({of + ", time", content.time_unit, c.time});
      data.push_back({of + ", pore pressure", "Pa", c.pressure});
    };
    add(second, who.second, false);
    add(first, who.first, both);
    names += (q == 0 ? "" : q + 1 == input.points.size() ? " and " : ", ") + letter_of(q);
  }
  draw_letters(*canvas, panel, ends);
  if (both) legend(*canvas, legend(*canvas, x, 3, Key::circle, ink, who.first, 3), 3, Key::line, ink, who.second);
  draw_key_map(*canvas, content, input.points, 132, y, 36, 48);
  const std::string of = both ? who.first + " (markers) and " + who.second + " (lines)" : first.empty() ? who.second : who.first;
  return {{"Pore pressure of the material points " + names + " against time, " + of + ".", canvas, "pressure_histories",
           "pore pressure of material points against time", std::move(data)}};
}

}  // namespace

FigureRow point_pressures_row() {
  return {.name = "pressure_histories",
          .shows = "pore pressure of material points against time",
          .section = Section::comparison,
          .applies = has_pressure,
          .draw = draw_point_pressures};
}

FigureRow point_curves_row() {
  return {.name = "histories",
          .shows = "displacement of material points against time",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) {
            return !i.points.empty() && (i.content.measured || i.content.simulated);
          },
          .draw = draw_point_curves};
}

}  // namespace pivnp::report

// Virtual extensometers and cross-sections, one figure a line.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/selection.hpp"
#include "apps/report/figures/rows.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/derived.hpp"
#include "pivnp/core/particles/places.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr std::string_view line_prefix = "line_";

struct Curve {
  bool measured = true;
  std::vector<double> x, y, sigma;
};

std::string place(const Vec2& at) { return "(" + plain(at.x()) + ", " + plain(at.y()) + ")"; }

Figure draw_curves(const FigureInput& input, const std::string& name, const std::vector<Curve>& curves, const std::string& x_label,
                   const std::string& y_label, double factor, std::string caption, const std::string& shows) {
  double left = std::numeric_limits<double>::infinity(), right = -left, low = left, high = -left;
  for (const Curve& c : curves)
    for (std::size_t k = 0; k < c.x.size(); ++k) {
      left = std::min(left, c.x[k]), right = std::max(right, c.x[k]);
      if (!std::isfinite(c.y[k])) continue;
      const double two = c.sigma.empty() || !std::isfinite(c.sigma[k]) ? 0 : 2 * c.sigma[k];
      low = std::min(low, c.y[k] - two), high = std::max(high, c.y[k] + two);
    }
  auto canvas = std::make_shared<Canvas>(half_figure_mm, 60);
  Panel panel = canvas->panel(15, 7, 65, 42);
  const double margin = high > low ? 0.05 * (high - low) : 1;
  panel.pale_grid().axis(Axis::x, left, right, x_label, 5);
  panel.axis(Axis::y, factor * (low - margin), factor * (high + margin), y_label, 5);
  double next = 15;
  bool banded = false;
  for (const Curve& c : curves) {
    std::vector<double> y = c.y, below, above;
    for (std::size_t k = 0; k < y.size(); ++k) {
      y[k] *= factor;
      if (c.sigma.empty()) continue;
      below.push_back(y[k] - 2 * factor * c.sigma[k]);
      above.push_back(y[k] + 2 * factor * c.sigma[k]);
    }
    if (!below.empty()) band(*canvas, panel, c.x, below, above, {blue, 70}), banded = true;
    if (c.measured) markers(*canvas, panel, c.x, y, Marker::circle, blue);
    else canvas->curve(panel, c.x, y, {vermilion, 1.3});
    next = legend(*canvas, next, 3, c.measured ? Key::circle : Key::line, c.measured ? blue : vermilion,
                  c.measured ? input.names.first : input.names.second, 3);
  }
  if (banded) legend(*canvas, next, 3, Key::band, blue, "\u00b12\u03c3");
  std::vector<ComparisonTable::Column> data;
  for (const Curve& c : curves) {
    const std::string who = c.measured ? input.names.first : input.names.second;
    data.push_back({who + ", " + x_label, "", c.x});
    data.push_back({who + ", " + shows, "", c.y});
    if (!c.sigma.empty()) data.push_back({who + ", standard uncertainty", "", c.sigma});
  }
  if (!input.content.alignment.empty()) caption += " " + input.content.alignment;
  return {std::move(caption), canvas, std::string(line_prefix) + name, shows, std::move(data)};
}

std::vector<Figure> draw_lines(const FigureInput& input) {
  const Content& content = input.content;
  std::vector<Figure> figures;
  for (const auto& [name, line] : input.options.lines) {
    if (!line.from_m || !line.to_m) continue;
    const Vec2 from((*line.from_m)[0], (*line.from_m)[1]), to((*line.to_m)[0], (*line.to_m)[1]);
    std::vector<Curve> curves;
    const bool along = line.type == LineType::section;
    const double time = input.times.empty() ? 0 : input.times.back();
    for (const auto& [motion, measured] : {std::pair{content.measured, true}, {content.simulated, false}}) {
      if (!motion) continue;
      if (along) {
        const std::optional<std::size_t> frame = frame_at(*motion, time);
        if (!frame) continue;
        SectionCurve c = section(*motion, line.field, input.central, *frame, from, to);
        curves.push_back({measured, std::move(c.distance), std::move(c.value), std::move(c.sigma)});
      } else {
        ExtensometerCurve c = extensometer(*motion, from, to);
        curves.push_back({measured, std::move(c.time), std::move(c.strain), std::move(c.sigma)});
      }
    }
    const bool known = std::any_of(curves.begin(), curves.end(), [](const Curve& c) {
      return std::any_of(c.y.begin(), c.y.end(), [](double v) { return std::isfinite(v); });
    });
    if (!known) continue;
    const std::string ends = "from " + place(from) + " to " + place(to) + unit_suffix(content.length_unit);
    if (!along) {
      figures.push_back(draw_curves(input, name, curves, axis_label("time", content.time_unit), "strain (%)", 100,
                                    "Extensometer \u201c" + name + "\u201d: strain of the line between the material points " + ends +
                                        " at the first frame.",
                                    "strain"));
      continue;
    }
    const DerivedField field = derived_field(line.field);
    double most = 0;
    for (const Curve& c : curves)
      for (const double v : c.y)
        if (std::isfinite(v)) most = std::max(most, std::abs(v));
    const DisplayUnit unit = display_unit(field_unit(field, content), most);
    figures.push_back(draw_curves(input, name, curves, axis_label("distance", content.length_unit), axis_label(field.label, unit.name), unit.factor,
                                  "Section \u201c" + name + "\u201d at " + plain(time) + unit_suffix(content.time_unit) + ": " + field.label +
                                      " along the line " + ends + ", of the nearest particle.",
                                  field.label));
  }
  return figures;
}

}  // namespace

FigureRow lines_row() {
  return {.name = "line",
          .shows = "a field along a line, or the strain of one",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return !i.options.lines.empty() && (i.content.measured || i.content.simulated); },
          .draw = draw_lines,
          .owns = [](std::string_view figure) { return figure.starts_with(line_prefix); }};
}

}  // namespace pivnp::report

// RMS difference against time beside the measurement's own uncertainty.
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

std::vector<Figure> draw_differences(const FigureInput& input) {
  const DifferenceCurve& d = input.differences;
  const double largest = quantile(d.rms, 1), sigma = quantile(d.sigma, 1);
  if (!std::isfinite(largest)) return {};
  const bool known = std::isfinite(sigma) && sigma > 0, log = known && largest > 40 * sigma;
  const double top = std::max(largest, std::isfinite(sigma) ? sigma : 0);
  const DisplayUnit unit = display_unit(input.content.length_unit, top);
  const auto shown = [&](std::vector<double> values) {
    for (double& v : values) v = log && !(v > 0) ? std::numeric_limits<double>::quiet_NaN() : v * unit.factor;
    return values;
  };
  const std::vector<double> rms = shown(d.rms), median = shown(d.median), own = shown(d.sigma);

  auto canvas = std::make_shared<Canvas>(half_figure_mm, 60);
  const double x = 15, y = 10, w = 65, h = 39;
  Panel panel = canvas->panel(x, y, w, h);
  panel.pale_grid();
  const double pad = 0.012 * (d.time.back() - d.time.front());
  panel.axis(Axis::x, d.time.front() - pad, d.time.back() + pad, axis_label("time", input.content.time_unit), 5);
  panel.axis(Axis::y, 0, top > 0 ? 1.08 * top * unit.factor : 1, axis_label("displacement difference", unit.name), 5);
  if (log) {
    const double low = quantile(median, 0.05);
    const double least = std::isfinite(low) ? std::min(quantile(own, 0), low) : quantile(own, 0);
    panel.logarithmic(Axis::y, 0.6 * least, 1.7 * top * unit.factor, 1);
  }
  if (known) {
    const std::vector<double> floor(own.size(), log ? panel.lower(Axis::y) : 0.0);
    band(*canvas, panel, d.time, floor, own, {ink, 45});
    canvas->curve(panel, d.time, own, {faint, 0.8, Dash::dotted});
  }
  canvas->curve(panel, d.time, median, {sky, 1.1, Dash::dashed});
  canvas->curve(panel, d.time, rms, {blue, 1.3});
  markers(*canvas, panel, d.time, rms, Marker::circle, blue);
  double next = legend(*canvas, x, 3, Key::line, blue, "RMS");
  next = legend(*canvas, next, 3, Key::dashed, sky, "median");
  if (known)
    legend(*canvas, x, 7, Key::band, ink,
           "uncertainty of " + input.names.the_first);

  std::string caption =
      "Difference of displacement, " + input.names.difference() + ", over the compared particles against time.";
  caption += known ? " Grey: what " + input.names.the_first +
                         " itself is uncertain by (random error, one standard deviation); a difference inside it has "
                         "no meaning."
                   : " " + capitalised(input.names.the_first) + " states no uncertainty.";
  if (log) caption += " Logarithmic scale.";
  const std::string &length = input.content.length_unit, &clock = input.content.time_unit;
  return {{caption, canvas, {}, {}, {{"time", clock, d.time}, {"RMS", length, d.rms}, {"median", length, d.median},
                                     {"standard uncertainty", length, d.sigma}}}};
}

}  // namespace

FigureRow differences_row() {
  return {.name = "difference",
          .shows = "difference of displacement against time",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return i.differences.time.size() >= 2; },
          .draw = draw_differences};
}

}  // namespace pivnp::report

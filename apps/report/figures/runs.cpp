// Several runs beside each other: how far their material moved, against time.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

struct RunLook {
  Rgb rgb;
  Dash dash;
  Key key;
};
constexpr std::array<RunLook, 6> run_looks = {{{blue, Dash::solid, Key::line},
                                               {vermilion, Dash::dashed, Key::dashed},
                                               {green, Dash::dotted, Key::dotted},
                                               {purple, Dash::dash_dot, Key::dash_dot},
                                               {sky, Dash::solid, Key::line},
                                               {orange, Dash::dashed, Key::dashed}}};

std::vector<Figure> draw_runs(const FigureInput& input) {
  const Content& content = input.content;
  double first = std::numeric_limits<double>::infinity(), last = -first, top = 0;
  for (const Run& run : content.runs)
    for (std::size_t k = 0; k < run.time.size(); ++k) {
      first = std::min(first, run.time[k]), last = std::max(last, run.time[k]);
      if (std::isfinite(run.displacement[k])) top = std::max(top, run.displacement[k]);
    }
  if (!(last > first) || !(top > 0)) return {};
  const DisplayUnit unit = display_unit(content.length_unit, top);
  auto canvas = std::make_shared<Canvas>(figure_width_mm, 70);
  const double x = 17, w = 100;
  Panel panel = canvas->panel(x, 5, w, 52);
  panel.pale_grid().axis(Axis::x, first, last, axis_label("time", content.time_unit), 6);
  panel.axis(Axis::y, 0, 1.05 * top * unit.factor, axis_label("displacement, 95th percentile", unit.name), 5);
  std::vector<ComparisonTable::Column> data;
  double key_y = 8;
  for (std::size_t k = 0; k < content.runs.size(); ++k) {
    const Run& run = content.runs[k];
    const RunLook& look = run_looks[k % run_looks.size()];
    std::vector<double> y = run.displacement;
    for (double& v : y) v *= unit.factor;
    if (run.measured) markers(*canvas, panel, run.time, y, Marker::circle, ink);
    else canvas->curve(panel, run.time, y, {look.rgb, 1.3, look.dash});
    legend(*canvas, x + w + 5, key_y, run.measured ? Key::circle : look.key, run.measured ? ink : look.rgb, run.name);
    key_y += 5;
    data.push_back({run.name + ", time", content.time_unit, run.time});
    data.push_back({run.name + ", displacement", content.length_unit, run.displacement});
  }
  return {{"Runs beside each other: the displacement that 95 % of the particles do not exceed, against time.", canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow runs_row() {
  return {.name = "runs",
          .shows = "displacement of several runs against time",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return i.content.runs.size() > 1; },
          .draw = draw_runs};
}

}  // namespace pivnp::report

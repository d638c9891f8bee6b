#include "apps/plot/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/plot/marks.hpp"

namespace pivnp::plot {

namespace {

struct Look {
  Rgb rgb;
  Dash dash;
  Key key;
};
constexpr std::array<Look, 6> looks = {{{blue, Dash::solid, Key::line},
                                        {vermilion, Dash::dashed, Key::dashed},
                                        {green, Dash::dotted, Key::dotted},
                                        {ink, Dash::dash_dot, Key::dash_dot},
                                        {sky, Dash::solid, Key::line},
                                        {purple, Dash::dashed, Key::dashed}}};

struct Range {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  void take(double v, bool positive = false) {
    if (!std::isfinite(v) || (positive && !(v > 0))) return;
    lower = std::min(lower, v);
    upper = std::max(upper, v);
  }
};

}  // namespace

void write_chart(const Chart& chart, const std::filesystem::path& file) {
  Range x, y;
  for (const ChartCurve& c : chart.curves)
    for (std::size_t k = 0; k < c.x.size(); ++k) x.take(c.x[k]), y.take(c.y[k], chart.logarithmic);
  if (!(x.upper > x.lower)) x = {0, 1};
  if (!(y.upper > 0)) y = {0.1, 1};
  Canvas canvas(150, 90);
  Panel panel = canvas.panel(17, 9, 128, 68);
  panel.pale_grid();
  panel.axis(Axis::x, x.lower, x.upper, chart.x_label, 8);
  panel.axis(Axis::y, std::min(0.0, 1.05 * y.lower), 1.05 * y.upper, chart.y_label, 5);
  if (chart.logarithmic) panel.logarithmic(Axis::y, 0.7 * y.lower, 1.5 * y.upper, 2);
  double next = 17;
  for (std::size_t k = 0; k < chart.curves.size() && k < looks.size(); ++k) {
    ChartCurve c = chart.curves[k];
    for (double& v : c.y)
      if (chart.logarithmic && !(v > 0)) v = std::numeric_limits<double>::quiet_NaN();
    canvas.curve(panel, c.x, c.y, {looks[k].rgb, 1.3, looks[k].dash});
    next = legend(canvas, next, 4, looks[k].key, looks[k].rgb, c.name);
  }
  save(canvas, file, 200);
}

}  // namespace pivnp::plot

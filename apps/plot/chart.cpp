#include "apps/plot/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/plot/files.hpp"
#include "apps/plot/parts.hpp"

namespace pivnp::report {

namespace {

struct Look {
  Rgb rgb;
  Qt::PenStyle style;
  Key key;
};
const std::array<Look, 6> looks = {{{blue, Qt::SolidLine, Key::line},
                                    {vermilion, Qt::DashLine, Key::dashed},
                                    {green, Qt::DotLine, Key::dotted},
                                    {ink, Qt::DashDotLine, Key::dash_dot},
                                    {sky, Qt::SolidLine, Key::line},
                                    {purple, Qt::DashLine, Key::dashed}}};

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
  start_qt();
  Range x, y;
  for (const ChartCurve& c : chart.curves)
    for (std::size_t k = 0; k < c.x.size(); ++k) x.take(c.x[k]), y.take(c.y[k], chart.logarithmic);
  if (!(x.upper > x.lower)) x = {0, 1};
  if (!(y.upper > 0)) y = {0.1, 1};
  Sheet sheet(150, 90);
  QCPAxisRect* panel = sheet.panel(17, 9, 128, 68);
  pale_grid(panel);
  set_axis(panel->axis(QCPAxis::atBottom), x.lower, x.upper, qt(chart.x_label), 8);
  QCPAxis* axis = panel->axis(QCPAxis::atLeft);
  set_axis(axis, std::min(0.0, 1.05 * y.lower), 1.05 * y.upper, qt(chart.y_label), 5);
  if (chart.logarithmic) {
    axis->setScaleType(QCPAxis::stLogarithmic);
    axis->setTicker(QSharedPointer<QCPAxisTickerLog>::create());
    axis->setRange(0.7 * y.lower, 1.5 * y.upper);
    axis->setNumberFormat("gb");
    axis->setNumberPrecision(2);
  }
  double next = 17;
  for (std::size_t k = 0; k < chart.curves.size() && k < looks.size(); ++k) {
    ChartCurve c = chart.curves[k];
    for (double& v : c.y)
      if (chart.logarithmic && !(v > 0)) v = std::numeric_limits<double>::quiet_NaN();
    curve(sheet, panel, c.x, c.y, pen(looks[k].rgb, 1.3, looks[k].style));
    next = draw_key(sheet, next, 4, looks[k].key, looks[k].rgb, qt(c.name));
  }
  const QByteArray svg = sheet.svg(), png = sheet.png(200);
  make_folder(file.parent_path());
  write_file(file.string() + ".svg", {svg.constData(), std::size_t(svg.size())});
  write_file(file.string() + ".png", {png.constData(), std::size_t(png.size())});
}

}  // namespace pivnp::report

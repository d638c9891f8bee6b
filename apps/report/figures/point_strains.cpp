// Deviatoric strain of material points against time, with what the measurement states of its error.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/point_curves.hpp"
#include "apps/report/figures/points.hpp"
#include "apps/report/figures/rows.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

bool states_strain_error(const MotionSource& motion) {
  return !motion.times().empty() && motion.frame(motion.times().size() - 1).find("cov_F") != nullptr;
}

std::vector<Figure> draw_point_strains(const FigureInput& input) {
  const Content& content = input.content;
  std::vector<PointCurve> measured, simulated;
  if (content.measured) measured = point_curves(*content.measured, input.points);
  if (content.simulated) simulated = point_curves(*content.simulated, input.points);
  double top = 0, most = 0, first = std::numeric_limits<double>::infinity(), last = -first;
  for (const auto* curves : {&measured, &simulated})
    for (const PointCurve& c : *curves)
      for (std::size_t k = 0; k < c.time.size(); ++k) {
        first = std::min(first, c.time[k]), last = std::max(last, c.time[k]);
        const double two = c.strain_sigma.empty() || !std::isfinite(c.strain_sigma[k]) ? 0 : 2 * c.strain_sigma[k];
        if (!std::isfinite(c.strain[k])) continue;
        most = std::max(most, 100 * c.strain[k]);
        top = std::max(top, 100 * (c.strain[k] + two));
      }
  // Of strain that is hardly known at all the curves are to be seen, and not the band alone.
  constexpr double most_of_band = 3;
  const bool cut = most > 0 && top > most_of_band * most;
  if (cut) top = most_of_band * most;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, 60);
  Panel panel = canvas->panel(15, 7, 62, 42);
  const double span = last - first;
  panel.pale_grid();
  panel.axis(Axis::x, first - 0.015 * span, span > 0 ? last + 0.03 * span : last, axis_label("time", content.time_unit), 5);
  panel.axis(Axis::y, 0, top > 0 ? 1.05 * top : 1, "deviatoric strain (%)", 5);
  std::vector<ComparisonTable::Column> data;
  std::string names;
  for (std::size_t q = 0; q < input.points.size(); ++q) {
    const Rgb rgb = point_colours[q % 3];
    double label = nan_value;
    const auto keep = [&](const PointCurve& c, const std::string& who) {
      data.push_back({who + " " + letter_of(q) + ", time", content.time_unit, c.time});
      data.push_back({who + " " + letter_of(q) + ", deviatoric strain", "", c.strain});
      if (!c.strain_sigma.empty()) data.push_back({who + " " + letter_of(q) + ", standard uncertainty", "", c.strain_sigma});
      for (const double v : c.strain)
        if (std::isfinite(v)) label = 100 * v;
    };
    if (q < simulated.size()) {
      canvas->curve(panel, simulated[q].time, scaled(simulated[q].strain, 100), {rgb, 1.3, q < 3 ? Dash::solid : Dash::dashed});
      keep(simulated[q], input.names.second);
    }
    if (q < measured.size()) {
      const PointCurve& c = measured[q];
      if (!c.strain_sigma.empty()) {
        std::vector<double> low, high;
        for (std::size_t k = 0; k < c.time.size(); ++k) {
          low.push_back(100 * std::max(0.0, c.strain[k] - 2 * c.strain_sigma[k]));
          high.push_back(std::min(cut ? top : top + 1, 100 * (c.strain[k] + 2 * c.strain_sigma[k])));
        }
        band(*canvas, panel, c.time, low, high, {rgb, 70});
      }
      markers(*canvas, panel, c.time, scaled(c.strain, 100), point_markers[q % 3], rgb);
      keep(c, input.names.first);
    }
    if (std::isfinite(label))
      canvas->paint_over([=](Painter& p) {
        p.text({panel.frame().right() + 7, panel.y(label) - 20, 60, 40}, letter_of(q), Align::left, {.bold = true, .rgb = rgb});
      });
    names += (q == 0 ? "" : q + 1 == input.points.size() ? " and " : ", ") + letter_of(q);
  }
  double next = 15;
  if (!measured.empty()) {
    next = legend(*canvas, next, 3, Key::circle, ink, input.names.first, 3);
    next = legend(*canvas, next, 3, Key::band, ink, "\u00b12\u03c3", 3);
  }
  if (!simulated.empty()) legend(*canvas, next, 3, Key::line, ink, input.names.second);
  std::string caption = "Deviatoric strain of the material points " + names + " against time. The band is twice the standard uncertainty " +
                        "that " + input.names.the_first + " states (random error: what averaging over the gauge length takes off is not in it).";
  if (cut) caption += " Bands are cut at three times the greatest strain.";
  if (!content.alignment.empty()) caption += " " + content.alignment;
  return {{std::move(caption), canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow point_strains_row() {
  return {.name = "strain_histories",
          .shows = "deviatoric strain of material points against time",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) {
            return !i.points.empty() && i.content.measured && states_strain_error(*i.content.measured);
          },
          .draw = draw_point_strains};
}

}  // namespace pivnp::report

// The two histories of a comparison of curves, from its tables.
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

struct TwoHistories {
  const ComparisonTable *first = nullptr, *second = nullptr;
  bool known() const { return first && second && first->columns.size() == 2 && second->columns.size() == 2; }
};

TwoHistories histories_of(const Content& content) {
  if (content.measured || content.simulated || !content.comparison) return {};
  return {content.comparison->table(history_table(DataSetRole::first)),
          content.comparison->table(history_table(DataSetRole::second))};
}

// "front of mpm of front=FILE" -> "front of mpm".
std::string curve_name(const std::string& definition) {
  return definition.substr(0, definition.rfind(" of ", definition.find('=')));
}

std::vector<Figure> draw_histories(const FigureInput& input) {
  const auto [first, second] = histories_of(input.content);
  double left = std::numeric_limits<double>::infinity(), right = -left, low = left, high = -left;
  for (const auto* table : {first, second})
    for (std::size_t k = 0; k < table->columns[0].values.size(); ++k) {
      const double t = table->columns[0].values[k], v = table->columns[1].values[k];
      if (!std::isfinite(t) || !std::isfinite(v)) continue;
      left = std::min(left, t), right = std::max(right, t);
      low = std::min(low, v), high = std::max(high, v);
    }
  if (!(right > left) || !(high > low)) return {};
  const DisplayUnit unit = display_unit(first->columns[1].unit, std::max(high, -low));
  const double x = 17, margin = 0.05 * (high - low);
  auto canvas = std::make_shared<Canvas>(figure_width_mm, 84);
  Panel panel = canvas->panel(x, 8, 150, 62);
  panel.pale_grid();
  panel.axis(Axis::x, left, right, axis_label("time", first->columns[0].unit), 8);
  panel.axis(Axis::y, (low - margin) * unit.factor, (high + margin) * unit.factor, axis_label("value", unit.name), 5);
  const auto scaled = [&](std::vector<double> values) {
    for (double& v : values) v *= unit.factor;
    return values;
  };
  canvas->curve(panel, first->columns[0].values, scaled(first->columns[1].values), {ink, 1.2});
  canvas->curve(panel, second->columns[0].values, scaled(second->columns[1].values), {vermilion, 1.2, Dash::dashed});
  const double next = legend(*canvas, x, 3, Key::line, ink, "first: " + curve_name(first->definition));
  legend(*canvas, next, 3, Key::dashed, vermilion, "second: " + curve_name(second->definition));
  return {{"The two histories. First: " + first->definition + ". Second: " + second->definition + ".", canvas, {}, {},
           {first->columns[0], first->columns[1], second->columns[0], second->columns[1]}}};
}

}  // namespace

FigureRow histories_row() {
  return {.name = "curves",
          .shows = "the two histories that were compared",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return histories_of(i.content).known(); },
          .draw = draw_histories};
}

}  // namespace pivnp::report

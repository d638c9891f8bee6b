// What the comparison found beside fields and curves: coefficients of both sides and their band.
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/plot/numbers.hpp"
#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/data_sets.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

struct Coefficients {
  std::string words, unit;
  const std::vector<double>*first = nullptr, *second = nullptr;
  double uncertainty = 0;
};

std::vector<Coefficients> coefficients(const Comparison& comparison) {
  static const std::string prefix = "decomposition_";
  std::vector<Coefficients> out;
  for (const ComparisonTable& table : comparison.tables) {
    if (!table.name.starts_with(prefix)) continue;
    const auto *first = find(table, name_of(DataSetRole::first)), *second = find(table, name_of(DataSetRole::second)),
               *uncertainty = find(table, "uncertainty");
    if (first == nullptr || second == nullptr || first->values.empty()) continue;
    if (first->values.size() != second->values.size()) continue;
    out.push_back({field_words(table.name.substr(prefix.size())), first->unit, &first->values, &second->values,
                   uncertainty != nullptr && !uncertainty->values.empty() ? uncertainty->values[0] : 0});
  }
  return out;
}

}  // namespace

std::optional<Figure> decomposition_figure(const Content& content) {
  if (!content.comparison) return std::nullopt;
  const std::vector<Coefficients> all = coefficients(*content.comparison);
  if (all.empty()) return std::nullopt;
  const double left = 15, gap = 17, head = 7, side = (figure_width_mm - left - 3 - 2 * gap) / 3;
  auto sheet = std::make_shared<Sheet>(figure_width_mm, head + side + 12);
  for (std::size_t k = 0; k < std::min<std::size_t>(3, all.size()); ++k) {
    const Coefficients& c = all[k];
    double least = 0, most = 0;
    for (const auto* values : {c.first, c.second})
      for (const double v : *values) {
        least = std::min(least, v);
        most = std::max(most, v);
      }
    const DisplayUnit unit = display_unit(c.unit, std::max(most, -least));
    const double margin = most > least ? 0.06 * (most - least) : 1;
    const double low = (least - margin) * unit.factor, high = (most + margin) * unit.factor;
    QCPAxisRect* panel = sheet->panel(left + double(k) * (side + gap), head, side, side);
    set_axis(panel->axis(QCPAxis::atBottom), low, high,
             axis_label(qt(in_sides(content, "s measured, ") + c.words), unit.name), 3);
    set_axis(panel->axis(QCPAxis::atLeft), low, high, axis_label(qt(in_sides(content, "s simulated")), unit.name), 3);
    const double two = 2 * c.uncertainty * unit.factor;
    band(*sheet, panel, {low, high}, {low - two, high - two}, {low + two, high + two}, ink, 45);
    curve(*sheet, panel, {low, high}, {low, high}, pen(faint, 0.7));
    std::vector<double> x, y;
    for (std::size_t n = 0; n < c.first->size(); ++n) {
      x.push_back((*c.first)[n] * unit.factor);
      y.push_back((*c.second)[n] * unit.factor);
    }
    QCPGraph* points = sheet->graph(panel);
    points->setLineStyle(QCPGraph::lsNone);
    points->setScatterStyle(
        QCPScatterStyle(QCPScatterStyle::ssCircle, pen(blue, 0.8), QBrush(Qt::white), 1.5 * units_per_mm));
    points->setData(QVector<double>(x.begin(), x.end()), QVector<double>(y.begin(), y.end()));
  }
  const double next = draw_key(*sheet, left, 3, Key::circle, blue, "coefficients");
  draw_key(*sheet, next, 3, Key::band, ink, "acceptance band");
  return Figure{
      "decomposition",
      "Coefficients of both sides at the last compared time, by polynomials orthonormal on the material (CEN CWA "
      "16799). Grey: twice the " +
          in_sides(content, "measured") + " coefficients\u2019 uncertainty about equality.",
      sheet};
}

namespace {

// "front of history=FILE" -> "front".
std::string curve_name(const std::string& definition) {
  for (const char* end : {" of history=", " of front=", " of front_left="})
    if (const std::size_t at = definition.find(end); at != std::string::npos) return definition.substr(0, at);
  return definition;
}

}  // namespace

std::optional<Figure> compared_curves_figure(const Content& content) {
  if (!content.comparison) return std::nullopt;
  const ComparisonTable *first = content.comparison->table(history_table(DataSetRole::first)),
                        *second = content.comparison->table(history_table(DataSetRole::second));
  if (!first || !second || first->columns.size() != 2 || second->columns.size() != 2) return std::nullopt;
  double left = std::numeric_limits<double>::infinity(), right = -left, low = left, high = -left;
  for (const auto* table : {first, second})
    for (std::size_t k = 0; k < table->columns[0].values.size(); ++k) {
      const double t = table->columns[0].values[k], v = table->columns[1].values[k];
      if (!std::isfinite(t) || !std::isfinite(v)) continue;
      left = std::min(left, t), right = std::max(right, t);
      low = std::min(low, v), high = std::max(high, v);
    }
  if (!(right > left) || !(high > low)) return std::nullopt;
  const DisplayUnit unit = display_unit(first->columns[1].unit, std::max(high, -low));
  const double x = 17, margin = 0.05 * (high - low);
  auto sheet = std::make_shared<Sheet>(figure_width_mm, 84);
  QCPAxisRect* panel = sheet->panel(x, 8, 150, 62);
  pale_grid(panel);
  set_axis(panel->axis(QCPAxis::atBottom), left, right, axis_label("time", first->columns[0].unit), 8);
  set_axis(panel->axis(QCPAxis::atLeft), (low - margin) * unit.factor, (high + margin) * unit.factor,
           axis_label("value", unit.name), 5);
  const auto scaled = [&](std::vector<double> values) {
    for (double& v : values) v *= unit.factor;
    return values;
  };
  curve(*sheet, panel, first->columns[0].values, scaled(first->columns[1].values), pen(ink, 1.2));
  curve(*sheet, panel, second->columns[0].values, scaled(second->columns[1].values),
        pen(vermilion, 1.2, Qt::DashLine));
  const std::string one = curve_name(first->definition), two = curve_name(second->definition);
  const double next = draw_key(*sheet, x, 3, Key::line, ink, qt("first: " + one));
  draw_key(*sheet, next, 3, Key::dashed, vermilion, qt("second: " + two));
  return Figure{"curves", "The two histories. First: " + first->definition + ". Second: " + second->definition + ".",
                sheet};
}

}  // namespace pivnp::report

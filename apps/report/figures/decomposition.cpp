// Coefficients of both data sets and the band within which they agree.
#include <algorithm>
#include <cmath>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/rows.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr std::string_view prefix = "decomposition_";

struct Coefficients {
  std::string words, unit;
  const std::vector<double>*first = nullptr, *second = nullptr;
  double uncertainty = 0;
};

std::vector<Coefficients> coefficients(const Comparison& comparison) {
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

std::vector<Figure> draw_decomposition(const FigureInput& input) {
  const std::vector<Coefficients> all = coefficients(*input.content.comparison);
  if (all.empty()) return {};
  const DataSetNames& names = input.names;
  const double left = 15, gap = 17, head = 7, edge = 40;
  auto canvas = std::make_shared<Canvas>(figure_width_mm, head + edge + 12);
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
    Panel panel = canvas->panel(left + double(k) * (edge + gap), head, edge, edge);
    panel.axis(Axis::x, low, high, axis_label("s " + names.first + ", " + c.words, unit.name), 3);
    panel.axis(Axis::y, low, high, axis_label("s " + names.second, unit.name), 3);
    const double two = 2 * c.uncertainty * unit.factor;
    band(*canvas, panel, {low, high}, {low - two, high - two}, {low + two, high + two}, {ink, 45});
    canvas->curve(panel, {low, high}, {low, high}, {faint, 0.7});
    std::vector<double> x, y;
    for (std::size_t n = 0; n < c.first->size(); ++n) {
      x.push_back((*c.first)[n] * unit.factor);
      y.push_back((*c.second)[n] * unit.factor);
    }
    canvas->points(panel, x, y, {.marker = Marker::circle, .pen = {blue, 0.8}, .size_mm = 1.5});
  }
  std::vector<ComparisonTable::Column> data;
  for (const Coefficients& c : all) {
    data.push_back({names.first + ", " + c.words, c.unit, *c.first});
    data.push_back({names.second + ", " + c.words, c.unit, *c.second});
  }
  const double next = legend(*canvas, left, 3, Key::circle, blue, "coefficients");
  legend(*canvas, next, 3, Key::band, ink, "acceptance band");
  return {{"Coefficients of both data sets at the last compared time, by polynomials orthonormal on the material (CEN CWA "
           "16799). Grey: twice the " + names.first + " coefficients\u2019 uncertainty about equality.",
           canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow decomposition_row() {
  return {.name = "decomposition",
          .shows = "coefficients of the decomposition of both data sets",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return i.content.comparison.has_value(); },
          .draw = draw_decomposition};
}

}  // namespace pivnp::report

// Final outlines overlaid.
#include <algorithm>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

using Loops = std::vector<std::vector<Vec2>>;

Loops placed(const Panel& panel, Loops loops) {
  for (std::vector<Vec2>& loop : loops)
    for (Vec2& x : loop) x = panel.at(x);
  return loops;
}

std::vector<Figure> draw_outlines(const FigureInput& input) {
  const PerDataSet<Loops>& outlines = input.content.comparison->outlines;
  std::vector<const std::vector<Vec2>*> all;
  for (const Loops& loops : outlines)
    for (const std::vector<Vec2>& loop : loops) all.push_back(&loop);
  const Box box = box_around(all, 0);
  const double aspect = box.height() / box.width(), left = 12, head = 7, foot = 10;
  const double w = std::min(half_figure_mm - left - 2, 75 / aspect), h = w * aspect, x = left + (half_figure_mm - left - 2 - w) / 2;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, head + h + foot);
  const Panel panel = world_panel(*canvas, x, head, w, h, box, input.content.length_unit, true, true);
  canvas->paint(panel, [=](Painter& p) {
    p.pen({ink, 1.2});
    p.fill({0xe4e4e4});
    p.rings(placed(panel, outlines[0]));
    p.pen({vermilion, 1.2, Dash::dashed});
    p.no_fill();
    p.rings(placed(panel, outlines[1]));
  });
  const double next = legend(*canvas, x, 3, Key::line, ink, input.names.first);
  legend(*canvas, next, 3, Key::dashed, vermilion, input.names.second);
  std::vector<ComparisonTable::Column> data;
  for (const std::size_t s : {0u, 1u}) {
    const std::string who = s == 0 ? input.names.first : input.names.second;
    ComparisonTable::Column ring{who + " ring", "", {}}, across{who + " x", input.content.length_unit, {}},
        up{who + " y", input.content.length_unit, {}};
    for (std::size_t k = 0; k < outlines[s].size(); ++k)
      for (const Vec2& at : outlines[s][k]) {
        ring.values.push_back(double(k + 1));
        across.values.push_back(at.x());
        up.values.push_back(at.y());
      }
    for (auto* column : {&ring, &across, &up}) data.push_back(std::move(*column));
  }
  return {{"Outline of the material at the last compared time: " + input.names.first + " (filled) and " +
               input.names.second + " (dashed).",
           canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow outlines_row() {
  return {.name = "outline",
          .shows = "outlines of the material at the last compared time",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) {
            return i.content.comparison &&
                   !(i.content.comparison->outlines[0].empty() && i.content.comparison->outlines[1].empty());
          },
          .draw = draw_outlines};
}

}  // namespace pivnp::report

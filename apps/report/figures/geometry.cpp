// The final geometry: what moved and what stayed at rest.
#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/figures/rows.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr Rgb moved = orange, resting = 0xc9d3dc;

struct Side {
  std::string who;
  FieldAtTime at;
  std::vector<double> area;
};

std::vector<Figure> draw_geometry(const FigureInput& input) {
  const Content& content = input.content;
  const double time = input.times.back();
  std::vector<Side> sides;
  std::vector<const std::vector<Vec2>*> places;
  for (const auto& [motion, who] : {std::pair{content.measured, input.names.first}, {content.simulated, input.names.second}})
    if (motion) sides.push_back({who, fields_at(*motion, "displacement_magnitude", input.central, {time}).front(), motion->particles().area});
  for (const Side& side : sides) places.push_back(&side.at.position);
  double peak = 0;
  for (const double v : sides.front().at.value)
    if (std::isfinite(v)) peak = std::max(peak, v);
  const double threshold = content.mobilised > 0 ? content.mobilised : 0.05 * peak;
  if (!(threshold > 0)) return {};

  const Box box = box_around(places, 0.001);
  const double left = 14, gap = 6, head = 11, foot = 11, aspect = box.height() / box.width();
  const double w = std::min((half_figure_mm - left - 3 - gap * double(sides.size() - 1)) / double(sides.size()), 45 / aspect), h = w * aspect;
  const double x0 = left + (half_figure_mm - left - 3 - double(sides.size()) * w - gap * double(sides.size() - 1)) / 2;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, head + h + foot);
  std::string shares;
  std::vector<ComparisonTable::Column> data;
  for (std::size_t s = 0; s < sides.size(); ++s) {
    const FieldAtTime& at = sides[s].at;
    const double x = x0 + double(s) * (w + gap);
    const Panel panel = world_panel(*canvas, x, head, w, h, box, content.length_unit, true, s == 0);
    std::vector<Tile> tiles;
    double mobilised = 0, all = 0;
    ComparisonTable::Column px{sides[s].who + " x", content.length_unit, {}}, py{sides[s].who + " y", content.length_unit, {}},
        state{sides[s].who + " mobilised", "", {}};
    for (std::size_t p = 0; p < at.position.size(); ++p) {
      if (at.status[p] == ParticleStatus::unborn) continue;
      const bool known = std::isfinite(at.value[p]), moves = known && at.value[p] > threshold;
      tiles.push_back({at.position[p], at.half_x[p], at.half_y[p], !known ? ended_colour : moves ? moved : resting});
      px.values.push_back(at.position[p].x());
      py.values.push_back(at.position[p].y());
      state.values.push_back(known ? double(moves) : nan_value);
      if (!known || p >= sides[s].area.size()) continue;
      all += sides[s].area[p];
      mobilised += moves ? sides[s].area[p] : 0;
    }
    canvas->raster(panel, draw_tiles(tiles, box, int(w / 25.4 * 400)));
    canvas->text(x, head - 0.8, capitalised(sides[s].who), Align::bottom_left, {.bold = true});
    if (all > 0) shares += (shares.empty() ? "" : ", ") + sides[s].who + " " + percent(mobilised / all);
    for (auto* column : {&px, &py, &state}) data.push_back(std::move(*column));
  }
  const double next = legend(*canvas, left, 2.5, Key::tile, moved, "mobilised");
  legend(*canvas, next, 2.5, Key::tile, resting, "at rest");
  const DisplayUnit unit = display_unit(content.length_unit, threshold);
  std::string caption = "Final geometry at " + plain(time) + unit_suffix(content.time_unit) + ": material that moved by more than " +
                        significant(threshold * unit.factor, 3) + unit_suffix(unit.name) + ", and what stayed.";
  if (!shares.empty()) caption += " Mobilised share of the area: " + shares + ".";
  return {{caption, canvas, {}, {}, std::move(data)}};
}

}  // namespace

FigureRow geometry_row() {
  return {.name = "geometry",
          .shows = "the final geometry, mobilised and resting",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return !i.times.empty() && (i.content.measured || i.content.simulated); },
          .draw = draw_geometry};
}

}  // namespace pivnp::report

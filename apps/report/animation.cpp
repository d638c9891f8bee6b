#include "apps/report/animation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/plot/canvas.hpp"
#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/content/fields.hpp"
#include "apps/report/figures/vector_layer.hpp"
#include "apps/report/words/words.hpp"
#include "pivnp/core/particles/derived.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr double panel_mm = 76, side_mm = 14, top_mm = 9, bottom_mm = 24, dots_per_inch = 130;

bool central(const Content& content) { return content.pair_count == 0 || content.pair(0).anchor == Anchor::central; }

}  // namespace

Animation::Animation(const Content& content) : content_(content) {
  const MotionSource* leading = content.measured ? content.measured.get() : content.simulated.get();
  if (leading == nullptr) return;
  times_ = content.comparison && !content.comparison->times().empty() ? content.comparison->times() : leading->times();
  // One scale and one box for all pictures, from a few of them.
  std::vector<double> some, values;
  for (std::size_t k = 0; k < 5 && !times_.empty(); ++k) some.push_back(times_[k * (times_.size() - 1) / 4]);
  std::vector<std::vector<FieldAtTime>> held;
  std::vector<const std::vector<Vec2>*> places;
  for (const auto& motion : {content.measured, content.simulated})
    if (motion) held.push_back(fields_at(*motion, field_, central(content), some));
  for (const auto& list : held)
    for (const FieldAtTime& at : list) {
      places.push_back(&at.position);
      values.insert(values.end(), at.value.begin(), at.value.end());
    }
  scale_ = scale_for(values, false);
  box_ = box_around(places, 0.001);
}

int Animation::frame_of(std::size_t index) const {
  int best = -1;
  for (std::size_t k = 0; k < content_.frames.size(); ++k)
    if (best < 0 || std::abs(content_.frames[k].time - times_[index]) < std::abs(content_.frames[std::size_t(best)].time - times_[index])) best = int(k);
  return best;
}

std::string Animation::png(std::size_t index, const Picture& picture) const {
  const Image& image = picture.image;
  const double time = times_[index], h = panel_mm * box_.height() / box_.width();
  const bool pictured = content_.pair_count > 0;
  const std::size_t panels = std::size_t(pictured) + std::size_t(content_.measured != nullptr) + std::size_t(content_.simulated != nullptr);
  Canvas canvas(side_mm + double(panels) * (panel_mm + 4), top_mm + h + bottom_mm);
  const DataSetNames names = data_set_names(content_);
  double x = side_mm;
  const auto title = [&](const std::string& words) { canvas.text(x, top_mm - 1.5, words, Align::bottom_left, {.bold = true}); };
  const auto next_panel = [&] { return world_panel(canvas, x, top_mm, panel_mm, h, box_, content_.length_unit, true, x == side_mm); };
  if (pictured) {
    const Panel panel = next_panel();
    const int frame = frame_of(index);
    if (!image.empty()) canvas.raster(panel, draw_image(image.view(), picture.world_from_pixel.value_or(content_.world_from_pixel), box_, int(panel_mm / 25.4 * 200), 150, 254));
    for (std::size_t k = 0; k < content_.pair_count; ++k)
      if (const VectorField field = content_.pair(k); field.pair[0] == frame) {
        lay_vectors(canvas, panel, content_, field, panel_mm * units_per_mm / box_.width());
        break;
      }
    title("t = " + plain(time) + unit_suffix(content_.time_unit) + ", vectors");
    x += panel_mm + 4;
  }
  for (const auto& [motion, name] : {std::pair{content_.measured, names.first}, {content_.simulated, names.second}}) {
    if (!motion) continue;
    const Panel panel = next_panel();
    const FieldAtTime at = fields_at(*motion, field_, central(content_), {time}).front();
    std::vector<Tile> tiles;
    for (std::size_t p = 0; p < at.position.size(); ++p)
      if (at.status[p] != ParticleStatus::unborn)
        tiles.push_back({at.position[p], at.half_x[p], at.half_y[p], at.status[p] == ParticleStatus::ended ? ended_colour : scale_.at(at.value[p])});
    canvas.raster(panel, draw_tiles(tiles, box_, int(panel_mm / 25.4 * 200)));
    title((pictured ? "" : "t = " + plain(time) + unit_suffix(content_.time_unit) + ", ") + (pictured ? capitalised(name) : name));
    x += panel_mm + 4;
  }
  colour_bar(canvas, side_mm + 0.3 * panel_mm, top_mm + h + 12, panel_mm, scale_, 1, field_words(field_));
  return canvas.png(dots_per_inch);
}

}  // namespace pivnp::report

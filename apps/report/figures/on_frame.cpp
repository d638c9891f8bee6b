// What is laid over a frame of the experiment: the vectors' uncertainty, and shear bands.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/plot/raster.hpp"
#include "apps/report/content/material.hpp"
#include "apps/report/figures/rows.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr double left_mm = 12, right_mm = 1, head_mm = 10;

struct FramePanel {
  std::shared_ptr<Canvas> canvas;
  Panel panel;
  Box box;
  double x, y, width, height;
};

// A half figure of the frame with its scale bar, and `foot` below it.
FramePanel frame_panel(const Content& content, const Picture& picture, const Box& without, double foot) {
  const bool pictured = !picture.image.empty();
  const Mat3 world_from_pixel = picture.world_from_pixel.value_or(content.world_from_pixel);
  const Box box = pictured ? image_box(picture.image.width(), picture.image.height(), world_from_pixel) : without;
  const double aspect = box.height() / box.width();
  const double w = std::min(half_figure_mm - left_mm - right_mm, 80 / aspect), h = w * aspect, x = left_mm + (half_figure_mm - left_mm - right_mm - w) / 2;
  auto canvas = std::make_shared<Canvas>(half_figure_mm, head_mm + h + foot);
  const Panel panel = world_panel(*canvas, x, head_mm, w, h, box, content.length_unit, true, true);
  if (pictured)
    canvas->raster(panel, draw_image(picture.image.view(), world_from_pixel, box, std::clamp(int(w / 25.4 * 300), 64, 1400), 120, 252));
  scale_bar(*canvas, x + w, 7, panel, box, content.length_unit);
  return {canvas, panel, box, x, head_mm, w, h};
}

// Of each node in material: the root mean variance of one component over the pairs in which it is valid.
std::vector<double> sigma_of_nodes(const Content& content, Grid& grid) {
  std::vector<double> sum, count;
  for (std::size_t k = 0; k < content.pair_count; ++k) {
    const VectorField field = content.pair(k);
    const std::vector<std::uint8_t> material = nodes_in_material(content, field);
    grid = field.grid;
    sum.resize(field.status.size(), 0.0);
    count.resize(field.status.size(), 0.0);
    for (std::size_t n = 0; n < field.cov.size(); ++n) {
      const double v = (double(field.cov[n][0]) + double(field.cov[n][1])) / 2;
      if (field.status[n] != VectorStatus::valid || (!material.empty() && !material[n]) || !std::isfinite(v)) continue;
      sum[n] += v;
      count[n] += 1;
    }
  }
  std::vector<double> sigma(sum.size(), nan_value);
  for (std::size_t n = 0; n < sum.size(); ++n)
    if (count[n] > 0) sigma[n] = std::sqrt(sum[n] / count[n]);
  return sigma;
}

std::vector<Figure> draw_uncertainty(const FigureInput& input) {
  const Content& content = input.content;
  Grid grid;
  const std::vector<double> sigma = sigma_of_nodes(content, grid);
  if (!(quantile(sigma, 0.5) > 0)) return {};
  const Picture& picture = content.pictures.front();
  const FramePanel f = frame_panel(content, picture, {grid.origin - grid.spacing, grid.upper() + grid.spacing}, 24);
  const Scale scale = scale_for(sigma, false);
  std::vector<Tile> tiles;
  ComparisonTable::Column x{"x", content.length_unit, {}}, y{"y", content.length_unit, {}}, value{"standard uncertainty", content.length_unit, {}};
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const std::size_t n = grid.node(i, j);
      if (!std::isfinite(sigma[n])) continue;
      const Vec2 at = grid.position(i, j);
      tiles.push_back({at, Vec2(0.5 * grid.spacing.x(), 0), Vec2(0, 0.5 * grid.spacing.y()), scale.at(sigma[n])});
      x.values.push_back(at.x());
      y.values.push_back(at.y());
      value.values.push_back(sigma[n]);
    }
  Raster raster = draw_tiles(tiles, f.box, int(f.width / 25.4 * 300));
  for (std::uint32_t& pixel : raster.pixels) pixel = (pixel & 0x00ffffffu) | ((pixel >> 24) * 200 / 255) << 24;  // the frame shows through
  f.canvas->raster_over(f.x, f.y, f.width, f.height, raster);
  const DisplayUnit unit = display_unit(content.length_unit, scale.upper);
  colour_bar(*f.canvas, f.x + 0.15 * f.width, f.y + f.height + 12, 0.7 * f.width, scale, unit.factor, axis_label("standard uncertainty", unit.name));
  return {{"Standard uncertainty of a vector\u2019s component at each node where it was valid, RMS over the pairs (random error)" +
               std::string(picture.image.empty() ? "." : ", on " + frame_words(content, picture.frame) + "."),
           f.canvas, "uncertainty", "standard uncertainty of the vectors on the frame", {std::move(x), std::move(y), std::move(value)}}};
}

struct Bands {
  const ComparisonTable* table;
  Rgb rgb;
  Dash dash;
  std::string who;
};

std::vector<Bands> bands_of(const FigureInput& input) {
  std::vector<Bands> all;
  if (!input.content.comparison) return all;
  for (const DataSetRole role : data_set_roles) {
    const ComparisonTable* table = input.content.comparison->table("bands_" + std::string(name_of(role)));
    if (table == nullptr || find(*table, "x") == nullptr || find(*table, "length") == nullptr || find(*table, "inclination") == nullptr) continue;
    const bool first = role == DataSetRole::first;
    all.push_back({table, first ? red : blue, first ? Dash::solid : Dash::dashed, first ? input.names.first : input.names.second});
  }
  return all;
}

std::vector<Figure> draw_bands(const FigureInput& input) {
  const Content& content = input.content;
  const Picture& picture = *content.last_picture;
  const FramePanel f = frame_panel(content, picture, {}, 10);
  double next = f.x;
  std::vector<ComparisonTable::Column> data;
  for (const Bands& bands : bands_of(input)) {
    const auto column = [&](const char* name) { return find(*bands.table, name)->values; };
    const std::vector<double> x = column("x"), y = column("y"), length = column("length"), angle = column("inclination");
    f.canvas->paint(f.panel, [=, panel = f.panel](Painter& p) {
      for (std::size_t k = 0; k < x.size(); ++k) {
        const double a = angle[k] * std::numbers::pi / 180;
        const Vec2 centre(x[k], y[k]), half = 0.5 * length[k] * Vec2(std::cos(a), std::sin(a));
        for (const bool halo : {true, false}) {
          p.pen(halo ? Pen{0xffffff, 2.6} : Pen{bands.rgb, k == 0 ? 1.8 : 1.0, bands.dash});
          p.line(panel.at(centre - half), panel.at(centre + half));
        }
      }
    });
    next = legend(*f.canvas, next, 3, bands.dash == Dash::solid ? Key::line : Key::dashed, bands.rgb,
                  bands.who + ": " + count(x.size(), "band"), 3);
    for (const ComparisonTable::Column& c : bands.table->columns) data.push_back({bands.who + " " + c.name, c.unit, c.values});
  }
  return {{"Shear bands at the last compared time on " + frame_words(content, picture.frame) +
               ", each as the straight line of its length and inclination, the strongest thicker." +
               (content.alignment.empty() ? "" : " " + content.alignment),
           f.canvas, "bands", "shear bands on the frame", std::move(data)}};
}

}  // namespace

FigureRow uncertainty_row() {
  return {.name = "uncertainty",
          .shows = "standard uncertainty of the vectors on the frame",
          .section = Section::measurement,
          .applies = [](const FigureInput& i) { return !i.pairs.empty() && !i.content.pictures.empty(); },
          .draw = draw_uncertainty};
}

FigureRow bands_row() {
  return {.name = "bands",
          .shows = "shear bands on the frame",
          .section = Section::comparison,
          .applies = [](const FigureInput& i) { return !bands_of(i).empty() && i.content.last_picture != nullptr && !i.content.last_picture->image.empty(); },
          .draw = draw_bands};
}

}  // namespace pivnp::report

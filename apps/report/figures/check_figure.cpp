#include "apps/report/figures/check_figure.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apps/plot/files.hpp"
#include "apps/plot/marks.hpp"
#include "apps/plot/numbers.hpp"
#include "apps/report/figures/figure.hpp"

namespace pivnp::report {

using namespace plot;

namespace {

constexpr Rgb region_colour = 0x00795c, boundary_colour = vermilion, body_colour = purple, node_colour = 0x0b3d91;
constexpr std::uint32_t mask_tint = 0x6ed51e3c;  // with its alpha

Rgb colour_of(Outline::Kind kind) {
  return kind == Outline::Kind::region ? region_colour : kind == Outline::Kind::boundary ? boundary_colour : body_colour;
}

Box grown(Box box, const CheckInput& input) {
  box.lower = box.lower.cwiseMin(input.grid.origin);
  box.upper = box.upper.cwiseMax(input.grid.upper());
  if (input.image.data == nullptr)
    for (const Outline& outline : input.outlines)
      for (const Vec2& x : outline.points) {
        box.lower = box.lower.cwiseMin(x);
        box.upper = box.upper.cwiseMax(x);
      }
  return box;
}

Raster mask_raster(const CheckInput& input, const Box& box, int width) {
  Raster out{width, std::max(1, int(std::lround(width * box.height() / box.width()))), {}};
  out.pixels.assign(std::size_t(out.width) * std::size_t(out.height), 0);
  const Mat3 pixel_from_world = input.world_from_pixel.inverse();
  for (int r = 0; r < out.height; ++r)
    for (int c = 0; c < out.width; ++c) {
      const double x = box.lower.x() + (c + 0.5) / out.width * box.width();
      const double y = box.upper.y() - (r + 0.5) / out.height * box.height();
      const Eigen::Vector3d p = pixel_from_world * Eigen::Vector3d(x, y, 1);
      const int column = int(std::lround(p.x() / p.z())), row = int(std::lround(p.y() / p.z()));
      if (column < 0 || row < 0 || column >= input.mask.width || row >= input.mask.height) continue;
      if (!input.mask.usable(column, row)) out.pixels[std::size_t(r) * std::size_t(out.width) + std::size_t(c)] = mask_tint;
    }
  return out;
}

void draw_nodes(Canvas& canvas, const Panel& panel, const Grid& grid) {
  canvas.paint(panel, [=](Painter& p) {
    const double apart = panel.x(grid.spacing.x()) - panel.x(0);
    const double radius = std::clamp(0.12 * apart, 0.6, 3.0);
    p.no_pen();
    p.fill({node_colour, 190});
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) p.ellipse(panel.at(grid.position(i, j)), radius, radius);
  });
}

void draw_outline(Canvas& canvas, const Panel& panel, const Outline& outline) {
  if (outline.points.empty()) return;
  canvas.paint(panel, [=](Painter& p) {
    std::vector<Vec2> line;
    for (const Vec2& x : outline.points) line.push_back(panel.at(x));
    Vec2 least = line.front(), most = line.front();
    for (const Vec2& x : line) least = least.cwiseMin(x), most = most.cwiseMax(x);
    if (outline.closed) line.push_back(line.front());
    p.no_fill();
    for (const bool halo : {true, false}) {
      p.pen(halo ? Pen{0xffffff, 2.2} : Pen{colour_of(outline.kind), 1.2});
      p.polyline(line);
    }
    const double half = 5 * text_width(outline.name, small_text) + 8;
    const Vec2 middle = (least + most) / 2;
    const Rectangle plate{middle.x() - half, middle.y() - 17, 2 * half, 34};
    p.no_pen();
    p.fill({0xffffff, 215});
    p.rectangle(plate);
    p.text(plate, outline.name, Align::centre, {.points = small_text, .rgb = colour_of(outline.kind)});
  });
}

// Columns above and rows at the right, as masks and regions name them.
void draw_pixel_axes(Canvas& canvas, const Panel& panel, const CheckInput& input) {
  const auto world = [m = input.world_from_pixel, bent = input.to_world](double column, double row) {
    if (bent) return bent({column, row});
    const Eigen::Vector3d v = m * Eigen::Vector3d(column, row, 1);
    return Vec2(v.x() / v.z(), v.y() / v.z());
  };
  const int width = input.to_world ? input.columns : input.image.width, height = input.to_world ? input.rows : input.image.height;
  canvas.paint_over([=](Painter& p) {
    const Rectangle frame = panel.frame();
    p.pen({faint, 0.6});
    const double apart = nice_step(double(std::max(width, height)), 8);
    for (double c = 0; c < width; c += apart) {
      const double at = panel.at(world(c, 0)).x();
      p.line({at, frame.top}, {at, frame.top - 12});
      p.text({at - 100, frame.top - 46, 200, 32}, plain(c), Align::bottom, {.points = small_text, .rgb = faint});
    }
    for (double r = 0; r < height; r += apart) {
      const double at = panel.at(world(width - 1, r)).y(), right = frame.left + frame.width;
      p.line({right, at}, {right + 12, at});
      p.text({right + 18, at - 20, 120, 40}, plain(r), Align::left, {.points = small_text, .rgb = faint});
    }
  });
}

void draw_legend(Canvas& canvas, double x, const CheckInput& input) {
  x = legend(canvas, x, 3.2, Key::disc, node_colour,
             std::to_string(input.grid.nx) + " x " + std::to_string(input.grid.ny) + " nodes");
  const auto has = [&](Outline::Kind kind) {
    return std::any_of(input.outlines.begin(), input.outlines.end(), [&](const Outline& o) { return o.kind == kind; });
  };
  if (has(Outline::Kind::region)) x = legend(canvas, x, 3.2, Key::line, region_colour, "region");
  if (has(Outline::Kind::boundary)) x = legend(canvas, x, 3.2, Key::line, boundary_colour, "boundary");
  if (has(Outline::Kind::body)) x = legend(canvas, x, 3.2, Key::line, body_colour, "rigid body");
  if (input.mask.data != nullptr) legend(canvas, x, 3.2, Key::tile, 0xe9a0ae, "masked");
}

}  // namespace

void write_check(const CheckInput& input, const std::filesystem::path& file) {
  const bool pictured = input.image.data != nullptr;
  const Box box = grown(pictured ? image_box(input.image.width, input.image.height, input.world_from_pixel)
                                 : Box{input.grid.origin, input.grid.upper()}, input);
  const double left = 15, right = pictured ? 12 : 3, head = pictured ? 19 : 11, foot = 11, aspect = box.height() / box.width();
  const double w = std::min(figure_width_mm - left - right, (figure_height_mm - head - foot) / aspect), h = w * aspect;
  const double x = left + (figure_width_mm - left - right - w) / 2;
  Canvas canvas(figure_width_mm, head + h + foot);
  const Panel panel = world_panel(canvas, x, head, w, h, box, input.length_unit, true, true);
  const int pixels = std::clamp(int(w / 25.4 * 300), 64, 2000);
  if (pictured) canvas.raster(panel, draw_image(input.image, input.world_from_pixel, box, pixels, 40, 250));
  if (input.mask.data != nullptr) canvas.raster(panel, mask_raster(input, box, pixels));
  draw_nodes(canvas, panel, input.grid);
  for (const Outline& outline : input.outlines) draw_outline(canvas, panel, outline);
  scale_bar(canvas, x + w, 7.4, panel, box, input.length_unit);
  if (pictured) {
    draw_pixel_axes(canvas, panel, input);
    canvas.text(x, head - 5.2, "column (px); rows at the right", Align::bottom_left, {.points = small_text, .rgb = faint});
  }
  draw_legend(canvas, x, input);
  const std::string png = canvas.png(300);
  make_folder(file.parent_path());
  write_file(file, png);
}

}  // namespace pivnp::report

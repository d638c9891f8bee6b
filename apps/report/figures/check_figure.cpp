#include "apps/report/figures/check_figure.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "apps/plot/files.hpp"
#include "apps/plot/parts.hpp"
#include "apps/report/figures/figures.hpp"
#include "apps/report/words/words.hpp"

namespace pivnp::report {

namespace {

constexpr Rgb region_colour = 0x00795c, boundary_colour = vermilion, body_colour = purple, node_colour = 0x0b3d91;
constexpr QRgb mask_tint = qRgba(213, 30, 60, 110);

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

QImage mask_image(const CheckInput& input, const Box& box, int width) {
  const int height = std::max(1, int(std::lround(width * box.height() / box.width())));
  QImage out(width, height, QImage::Format_ARGB32);
  out.fill(Qt::transparent);
  const Mat3 pixel_from_world = input.world_from_pixel.inverse();
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const double x = box.lower.x() + (c + 0.5) / width * box.width();
      const double y = box.upper.y() - (r + 0.5) / height * box.height();
      const Eigen::Vector3d p = pixel_from_world * Eigen::Vector3d(x, y, 1);
      const int column = int(std::lround(p.x() / p.z())), row = int(std::lround(p.y() / p.z()));
      if (column < 0 || row < 0 || column >= input.mask.width || row >= input.mask.height) continue;
      if (!input.mask.usable(column, row)) out.setPixel(c, r, mask_tint);
    }
  return out;
}

void draw_nodes(Sheet& sheet, QCPAxisRect* panel, const Grid& grid) {
  sheet.paint(panel, [=](QCPPainter& p) {
    const double apart = x_of(panel, grid.spacing.x()) - x_of(panel, 0);
    const double radius = std::clamp(0.12 * apart, 0.6, 3.0);
    p.setPen(Qt::NoPen);
    p.setBrush(colour(node_colour, 190));
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const Vec2 x = grid.position(i, j);
        p.drawEllipse(QPointF(x_of(panel, x.x()), y_of(panel, x.y())), radius, radius);
      }
  });
}

void draw_outline(Sheet& sheet, QCPAxisRect* panel, const Outline& outline) {
  sheet.paint(panel, [=](QCPPainter& p) {
    QPolygonF line;
    for (const Vec2& x : outline.points) line << QPointF(x_of(panel, x.x()), y_of(panel, x.y()));
    if (outline.closed && !line.isEmpty()) line << line.front();
    p.setBrush(Qt::NoBrush);
    for (const bool halo : {true, false}) {
      p.setPen(halo ? pen(0xffffff, 2.2) : pen(colour_of(outline.kind), 1.2));
      p.drawPolyline(line);
    }
    QRectF bounds = line.boundingRect();
    const QRectF plate(bounds.center().x() - 5 * text_width(qt(outline.name), small_text) - 8, bounds.center().y() - 17,
                       10 * text_width(qt(outline.name), small_text) + 16, 34);
    p.setPen(Qt::NoPen);
    p.setBrush(QColor(255, 255, 255, 215));
    p.drawRect(plate);
    p.setPen(colour(colour_of(outline.kind)));
    p.setFont(font(small_text));
    p.drawText(plate, Qt::AlignCenter, qt(outline.name));
  });
}

void draw_legend(Sheet& sheet, double x, const CheckInput& input) {
  x = draw_key(sheet, x, 3.2, Key::disc, node_colour,
               qt(std::to_string(input.grid.nx) + " x " + std::to_string(input.grid.ny) + " nodes"));
  const auto has = [&](Outline::Kind kind) {
    return std::any_of(input.outlines.begin(), input.outlines.end(), [&](const Outline& o) { return o.kind == kind; });
  };
  if (has(Outline::Kind::region)) x = draw_key(sheet, x, 3.2, Key::line, region_colour, "region");
  if (has(Outline::Kind::boundary)) x = draw_key(sheet, x, 3.2, Key::line, boundary_colour, "boundary");
  if (has(Outline::Kind::body)) x = draw_key(sheet, x, 3.2, Key::line, body_colour, "rigid body");
  if (input.mask.data != nullptr) draw_key(sheet, x, 3.2, Key::tile, 0xe9a0ae, "masked");
}

}  // namespace

void write_check(const CheckInput& input, const std::filesystem::path& file) {
  start_qt();
  const bool pictured = input.image.data != nullptr;
  const Box box = grown(pictured ? image_box(input.image.width, input.image.height, input.world_from_pixel)
                                 : Box{input.grid.origin, input.grid.upper()}, input);
  const double left = 15, right = 3, head = 7, foot = 11, aspect = box.height() / box.width();
  const double w = std::min(figure_width_mm - left - right, (figure_height_mm - head - foot) / aspect), h = w * aspect;
  const double x = left + (figure_width_mm - left - right - w) / 2;
  Sheet sheet(figure_width_mm, head + h + foot);
  QCPAxisRect* panel = world_panel(sheet, x, head, w, h, box, input.length_unit, true, true);
  const int pixels = std::clamp(int(w / 25.4 * 300), 64, 2000);
  if (pictured) raster_in(sheet, panel, to_image(draw_image(input.image, input.world_from_pixel, box, pixels, 40, 250)));
  if (input.mask.data != nullptr) raster_in(sheet, panel, mask_image(input, box, pixels));
  draw_nodes(sheet, panel, input.grid);
  for (const Outline& outline : input.outlines) draw_outline(sheet, panel, outline);
  draw_scale_bar(sheet, panel, box, input.length_unit);
  draw_legend(sheet, x, input);
  const QByteArray png = sheet.png(300);
  make_folder(file.parent_path());
  write_file(file, std::string(png.constData(), std::size_t(png.size())));
}

}  // namespace pivnp::report

#include "apps/view/model/shapes.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "apps/case/values.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::view {

namespace {

double rounded(double value, double step) {
  const double places = std::pow(10.0, std::ceil(-std::log10(step)));
  return std::round(value * places) / places;
}

}  // namespace

std::vector<Shape> shapes_of(const app::Case& c, const image::Camera& camera) {
  std::vector<Shape> out;
  const auto add = [&](ShapeKind kind, app::KeyPath key, const Points& points, bool world, bool closed = true) {
    if (points.empty()) return;
    Shape shape{kind, std::move(key), world, closed, {}, false};
    for (const Vec2& p : positions_of(points)) shape.points.push_back(world ? camera.to_pixel(p) : p);
    for (const Vec2& p : shape.points)
      if (!p.allFinite()) return;
    out.push_back(std::move(shape));
  };
  for (const auto& [name, region] : c.regions) {
    add(ShapeKind::region, {"region", name, "polygon_px"}, region.polygon_px, false);
    add(ShapeKind::region, {"region", name, "polygon_m"}, region.polygon_m, true);
  }
  for (const auto& [name, mask] : c.masks) {
    add(ShapeKind::mask, {"mask", name, "polygon_px"}, mask.polygon_px, false);
    add(ShapeKind::mask, {"mask", name, "polygon_m"}, mask.polygon_m, true);
    if (mask.circle_px.size() != 3) continue;
    const std::size_t before = out.size();
    Points round;
    for (int k = 0; k < 64; ++k) {
      const double angle = 2 * std::numbers::pi * k / 64;
      round.push_back({mask.circle_px[0] + mask.circle_px[2] * std::cos(angle), mask.circle_px[1] + mask.circle_px[2] * std::sin(angle)});
    }
    add(ShapeKind::mask, {"mask", name, "circle_px"}, round, false);
    if (out.size() > before) out.back().circle = true;
  }
  for (const auto& [name, boundary] : c.boundaries) {
    add(ShapeKind::wall, {"boundary", name, "line_m"}, boundary.line_m, true, false);
    add(ShapeKind::wall, {"boundary", name, "polygon_m"}, boundary.polygon_m, true);
  }
  if (c.np) {
    add(ShapeKind::still_zone, {"np", "still_zone_px"}, c.np->still_zone_px, false);
    add(ShapeKind::still_zone, {"np", "still_zone_m"}, c.np->still_zone_m, true);
  }
  return out;
}

std::string toml_of(const Shape& shape, const image::Camera& camera) {
  Points points;
  for (const Vec2& p : shape.points) {
    if (!shape.world) {
      points.push_back({rounded(p.x(), 0.01), rounded(p.y(), 0.01)});
      continue;
    }
    const Vec2 x = camera.to_world(p);
    const double step = 0.01 * std::sqrt(std::abs(camera.jacobian(p).determinant()));
    points.push_back({rounded(x.x(), step), rounded(x.y(), step)});
  }
  return app::toml_text(points);
}

void require_outline(const Shape& shape) {
  const std::string what = shape.key.size() == 3 ? shape.key[0] + "." + shape.key[1] + "." + shape.key[2] : "np." + shape.key[1];
  if (shape.closed) {
    Polygon(shape.points, what);
  } else if (shape.points.size() != 2 || shape.points[0] == shape.points[1]) {
    throw InputError(what + ": found " + std::to_string(shape.points.size()) + " points, expected two ends that differ");
  }
}

}  // namespace pivnp::view

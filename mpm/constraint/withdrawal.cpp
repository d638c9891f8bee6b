#include "mpm/constraint/withdrawal.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pivnp/core/particles/region.hpp"

namespace pivnp::mpm {

namespace {

std::vector<Vec2> points_of(const Points& pairs) {
  std::vector<Vec2> points = positions_of(pairs);
  return points;
}

}  // namespace

double release_time(const BoundaryOptions& o, double until, const Vec2& x, double spacing) {
  if (!o.withdraw_m_s) return until;
  const Vec2 v((*o.withdraw_m_s)[0], (*o.withdraw_m_s)[1]);
  const bool is_polygon = o.line_m.empty();
  const std::vector<Vec2> vertices = points_of(is_polygon ? o.polygon_m : o.line_m);
  const auto distance = [&](const Vec2& y) {
    if (is_polygon) {
      const Polygon polygon(vertices, "boundary");
      Vec2 unused;
      return polygon.contains(y) ? 0.0 : polygon.distance(y, unused);
    }
    const Vec2 d = vertices[1] - vertices[0];
    const double on = std::clamp((y - vertices[0]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    return (y - vertices[0] - on * d).norm();
  };
  const double start = distance(x), tolerance = 0.01 * spacing;
  const double step = tolerance / v.norm();
  double length = 0;
  for (const Vec2& a : vertices)
    for (const Vec2& b : vertices) length = std::max(length, (a - b).norm());
  const double most = (length + 2 * spacing) / v.norm();
  double low = 0, high = most;
  for (double t = 0.25 * spacing / v.norm(); t < most; t += 0.25 * spacing / v.norm())
    if (distance(x - t * v) > start + tolerance) {
      high = t;
      low = t - 0.25 * spacing / v.norm();
      break;
    }
  while (high - low > step) {
    const double middle = 0.5 * (low + high);
    (distance(x - middle * v) > start + tolerance ? high : low) = middle;
  }
  const double raster = 0.1 * spacing / v.norm();
  return std::min(until, o.withdraw_from_s + std::ceil(high / raster) * raster);
}

}  // namespace pivnp::mpm

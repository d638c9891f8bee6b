#include "pivnp/core/particles/region.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_2_algorithms.h>

#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"

namespace pivnp {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;

std::vector<Point> cgal_points(const std::vector<Vec2>& vertices) {
  std::vector<Point> points;
  points.reserve(vertices.size());
  for (const Vec2& v : vertices) points.emplace_back(v.x(), v.y());
  return points;
}

double signed_area(const std::vector<Vec2>& v) {
  double twice = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    const Vec2& a = v[k];
    const Vec2& b = v[(k + 1) % v.size()];
    twice += a.x() * b.y() - b.x() * a.y();
  }
  return twice / 2;
}

// Sutherland & Hodgman (1974): the part of `in` on the side of `limit` along `axis` that `keep_below` names.
std::vector<Vec2> clipped(const std::vector<Vec2>& in, int axis, double limit, bool keep_below) {
  std::vector<Vec2> out;
  auto inside = [&](const Vec2& p) { return keep_below ? p[axis] <= limit : p[axis] >= limit; };
  for (std::size_t k = 0; k < in.size(); ++k) {
    const Vec2& a = in[k];
    const Vec2& b = in[(k + 1) % in.size()];
    if (inside(a)) out.push_back(a);
    if (inside(a) != inside(b)) {
      Vec2 cut = a + (b - a) * ((limit - a[axis]) / (b[axis] - a[axis]));
      cut[axis] = limit;
      out.push_back(cut);
    }
  }
  return out;
}

}  // namespace

std::vector<Vec2> positions_of(const Points& points) {
  std::vector<Vec2> positions;
  positions.reserve(points.size());
  for (const Pair& p : points) positions.emplace_back(p[0], p[1]);
  return positions;
}

Polygon::Polygon(std::vector<Vec2> vertices, const std::string& what) : vertices_(std::move(vertices)) {
  if (vertices_.size() > 1 && vertices_.front() == vertices_.back()) vertices_.pop_back();  // closed by hand
  if (vertices_.size() < 3)
    throw InputError(what + ": a polygon needs at least 3 vertices, found " + std::to_string(vertices_.size()));
  for (const Vec2& v : vertices_)
    if (!v.allFinite()) throw InputError(what + ": a vertex of the polygon is not a finite number");
  const std::vector<Point> points = cgal_points(vertices_);
  if (!CGAL::is_simple_2(points.begin(), points.end(), Kernel()))
    throw InputError(what + ": the polygon crosses or touches itself; list its vertices in order around it");
  area_ = signed_area(vertices_);
  if (area_ < 0) {
    std::reverse(vertices_.begin(), vertices_.end());
    area_ = -area_;
  }
  if (!(area_ > 0)) throw InputError(what + ": the polygon has no area");
  lower_ = upper_ = vertices_.front();
  for (const Vec2& v : vertices_) {
    lower_ = lower_.cwiseMin(v);
    upper_ = upper_.cwiseMax(v);
  }
}

bool Polygon::contains(const Vec2& x) const {
  if ((x.array() < lower_.array()).any() || (x.array() > upper_.array()).any()) return false;
  const std::vector<Point> points = cgal_points(vertices_);
  return CGAL::bounded_side_2(points.begin(), points.end(), Point(x.x(), x.y()), Kernel()) !=
         CGAL::ON_UNBOUNDED_SIDE;
}

double Polygon::overlap(const Vec2& box_lower, const Vec2& box_upper) const {
  std::vector<Vec2> part = vertices_;
  for (int axis = 0; axis < 2 && !part.empty(); ++axis) {
    part = clipped(part, axis, box_lower[axis], false);
    if (!part.empty()) part = clipped(part, axis, box_upper[axis], true);
  }
  return part.size() < 3 ? 0.0 : std::max(0.0, signed_area(part));
}

double Polygon::distance(const Vec2& x, Vec2& outward_normal) const {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const Vec2& a = vertices_[k];
    const Vec2 side = vertices_[(k + 1) % vertices_.size()] - a;
    const double t = std::clamp((x - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
    const double d = (x - (a + t * side)).norm();
    if (d < best) {
      best = d;
      outward_normal = Vec2(side.y(), -side.x()).normalized();
    }
  }
  return best;
}

}  // namespace pivnp

#include "pivnp/np/triangulation.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pivnp::np {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

double side_of(const Vec2& a, const Vec2& b, const Vec2& x) {
  return (b.x() - a.x()) * (x.y() - a.y()) - (b.y() - a.y()) * (x.x() - a.x());
}

}  // namespace

Triangulation::Triangulation(const std::vector<Vec2>& points) : points_(points) {
  std::vector<std::pair<Kernel::Point_2, int>> numbered;
  numbered.reserve(points.size());
  for (std::size_t p = 0; p < points.size(); ++p)
    numbered.emplace_back(Kernel::Point_2(points[p].x(), points[p].y()), int(p));
  Delaunay mesh;
  mesh.insert(numbered.begin(), numbered.end());
  if (mesh.dimension() < 2) return;
  for (auto face = mesh.all_faces_begin(); face != mesh.all_faces_end(); ++face) face->info() = -1;
  int count = 0;
  for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face) face->info() = count++;
  for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      t.node[std::size_t(k)] = face->vertex(k)->info();
      t.neighbour[std::size_t(k)] = face->neighbor(k)->info();
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 side = points_[std::size_t(t.node[k])] - points_[std::size_t(t.node[(k + 1) % 3])];
      t.longest = std::max(t.longest, side.norm());
    }
    triangles_.push_back(t);
  }
  sort_into_bins();
}

// About one bin a point: a walk from the bin's own triangle is a few steps long.
void Triangulation::sort_into_bins() {
  Vec2 upper = points_.front();
  lower_ = upper;
  for (const Vec2& p : points_) lower_ = lower_.cwiseMin(p), upper = upper.cwiseMax(p);
  const Vec2 extent = upper - lower_;
  bin_ = std::sqrt(extent.prod() / double(points_.size()));
  bins_x_ = std::max(1, int(std::ceil(extent.x() / bin_)));
  bins_y_ = std::max(1, int(std::ceil(extent.y() / bin_)));
  start_.assign(std::size_t(bins_x_) * std::size_t(bins_y_), 0);
  std::vector<double> nearest(start_.size(), -1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    Vec2 middle = Vec2::Zero();
    for (const int n : triangles_[t].node) middle += points_[std::size_t(n)] / 3;
    const Vec2 at = (middle - lower_) / bin_;
    const int i = std::clamp(int(at.x()), 0, bins_x_ - 1), j = std::clamp(int(at.y()), 0, bins_y_ - 1);
    const std::size_t bin = std::size_t(j) * std::size_t(bins_x_) + std::size_t(i);
    const double apart = (at - Vec2(i + 0.5, j + 0.5)).squaredNorm();
    if (nearest[bin] < 0 || apart < nearest[bin]) nearest[bin] = apart, start_[bin] = int(t);
  }
}

int Triangulation::locate(const Vec2& x) const {
  if (triangles_.empty() || !x.allFinite()) return -1;
  const Vec2 at = (x - lower_) / bin_;
  const int i = int(std::clamp(at.x(), 0.0, bins_x_ - 1.0)), j = int(std::clamp(at.y(), 0.0, bins_y_ - 1.0));
  int now = start_[std::size_t(j) * std::size_t(bins_x_) + std::size_t(i)];
  // A visibility walk ends on a Delaunay triangulation (Devillers, Pion & Teillaud 2002); rounding may still make it
  // hop between neighbours, hence the limit.
  for (std::size_t steps = 0; steps < triangles_.size() + 10; ++steps) {
    const Triangle& t = triangles_[std::size_t(now)];
    int next = now;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 &a = points_[std::size_t(t.node[(k + 1) % 3])], &b = points_[std::size_t(t.node[(k + 2) % 3])];
      const double out = side_of(a, b, x);
      if (out >= -1e-12 * (b - a).squaredNorm()) continue;
      next = t.neighbour[k];
      break;
    }
    if (next == now || next < 0) return next;
    now = next;
  }
  return -1;
}

}  // namespace pivnp::np

#include "compare/data/triangulation.hpp"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "compare/data/gradient_stencil.hpp"
#include "compare/data/nearest_edge.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::compare {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;  // index of the triangle kept, -1 if not
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;
using Point = Kernel::Point_2;

Delaunay triangulate(const std::vector<Vec2>& points) {
  std::vector<std::pair<Point, int>> numbered;
  numbered.reserve(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) numbered.emplace_back(Point(points[p].x(), points[p].y()), int(p));
  Delaunay mesh;
  mesh.insert(numbered.begin(), numbered.end());
  return mesh;
}

double circumradius(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double twice_area = std::abs(cross(b - a, c - a));
  return twice_area > 0 ? (b - a).norm() * (c - b).norm() * (a - c).norm() / (2 * twice_area)
                        : std::numeric_limits<double>::infinity();
}

}  // namespace

struct MaterialMesh::Impl {
  std::vector<Vec2> points;
  std::vector<double> spacing;
  Delaunay mesh;
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> boundary;
  NearestEdge nearest;
  Delaunay::Face_handle hint;

  void keep_triangles() {
    for (auto face = mesh.all_faces_begin(); face != mesh.all_faces_end(); ++face) face->info() = -1;
    for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face) {
      std::array<int, 3> corner;
      double mean_spacing = 0;
      for (int k = 0; k < 3; ++k) {
        corner[std::size_t(k)] = face->vertex(k)->info();
        mean_spacing += spacing[std::size_t(corner[std::size_t(k)])] / 3;
      }
      const double radius = circumradius(points[std::size_t(corner[0])], points[std::size_t(corner[1])],
                                         points[std::size_t(corner[2])]);
      if (!(radius <= alpha_ratio * mean_spacing)) continue;
      face->info() = int(triangles.size());
      triangles.push_back(corner);
    }
  }

  void find_boundary() {
    std::vector<char> has_triangle(points.size(), 0);
    for (const auto& corner : triangles)
      for (int v : corner) has_triangle[std::size_t(v)] = 1;
    // Of the kept triangles' sides, anticlockwise, in the order of the triangles. (CGAL's own list of edges goes by the faces'
    // addresses: with other memory it gives another order and other ends first, and last digits that follow.)
    if (mesh.dimension() == 2)
      for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face)
        for (int k = 0; face->info() >= 0 && k < 3; ++k)
          if (face->neighbor(k)->info() < 0)
            boundary.push_back({face->vertex(mesh.ccw(k))->info(), face->vertex(mesh.cw(k))->info()});
    for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v)
      if (!has_triangle[std::size_t(v->info())]) boundary.push_back({v->info(), v->info()});
  }

  void index_boundary() {
    std::vector<double> reach;
    for (const auto& [a, b] : boundary) reach.push_back((spacing[std::size_t(a)] + spacing[std::size_t(b)]) / 4);
    nearest.build(boundary, points, std::move(reach));
  }

  // Linear weights; rounding on a side may leave -1e-17, which is set to zero.
  Location inside(const std::array<int, 3>& corner, const Vec2& x) const {
    const Vec2 &a = points[std::size_t(corner[0])], &b = points[std::size_t(corner[1])],
               &c = points[std::size_t(corner[2])];
    const double whole = cross(b - a, c - a);
    const double wb = std::clamp(cross(x - a, c - a) / whole, 0.0, 1.0);
    const double wc = std::clamp(cross(b - a, x - a) / whole, 0.0, 1.0 - wb);
    return {corner, {1 - wb - wc, wb, wc}, Vec2::Zero()};
  }

  // Sibson's coordinates of a point that takes its cell from kept triangles alone; no shares if it does not, or if
  // round-off spoils them.
  std::vector<Natural::Share> sibson(const Vec2& x, Delaunay::Face_handle face) const {
    const Point query(x.x(), x.y());
    taken.clear(), hole.clear();
    mesh.get_conflicts_and_boundary(query, std::back_inserter(taken), std::back_inserter(hole), face);
    std::vector<Natural::Share> shares;
    const auto kept = [&](const Delaunay::Face_handle& f) { return !mesh.is_infinite(f) && f->info() >= 0; };
    if (hole.empty() || !std::all_of(taken.begin(), taken.end(), kept)) return shares;
    areas.clear();
    const double whole =
        CGAL::natural_neighbors_2(mesh, query, std::back_inserter(areas), hole.begin(), hole.end()).second;
    Vec2 found = Vec2::Zero();
    for (const auto& [vertex, area] : areas) {
      const Vec2& at = points[std::size_t(vertex->info())];
      shares.push_back({vertex->info(), area / whole, x - at});
      found += shares.back().weight * at;
    }
    const double local = shares.empty() ? 0 : spacing[std::size_t(shares.front().point)];
    if (!((found - x).norm() <= round_off * local)) shares.clear();
    return shares;
  }

  // Points that share a kept triangle with `vertex`.
  void add_ring(Delaunay::Vertex_handle vertex, std::vector<Delaunay::Vertex_handle>& ring) const {
    auto face = mesh.incident_faces(vertex);
    const auto begin = face;
    do {
      if (mesh.is_infinite(face) || face->info() < 0) continue;
      const int k = face->index(vertex);
      ring.push_back(face->vertex(Delaunay::ccw(k)));
      ring.push_back(face->vertex(Delaunay::cw(k)));
    } while (++face != begin);
  }

  // Weights of a gradient on the values at `points`, its own first (the negative sum of the others); empty: none.
  struct Gradient {
    bool sought = false;
    std::vector<int> points;
    std::vector<Vec2> weight;
  };

  const Gradient& gradient(int p) const {
    if (gradients.empty()) {
      gradients.resize(points.size());
      handles.resize(points.size());
      for (auto v = mesh.finite_vertices_begin(); v != mesh.finite_vertices_end(); ++v)
        handles[std::size_t(v->info())] = v;
    }
    Gradient& g = gradients[std::size_t(p)];
    if (std::exchange(g.sought, true)) return g;
    const Delaunay::Vertex_handle centre = handles[std::size_t(p)];
    std::vector<Delaunay::Vertex_handle> ring, second;
    add_ring(centre, ring);
    for (const Delaunay::Vertex_handle& v : ring) add_ring(v, second);
    ring.insert(ring.end(), second.begin(), second.end());
    std::vector<int> around;
    for (const Delaunay::Vertex_handle& v : ring)
      if (v != centre) around.push_back(v->info());
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    std::vector<Vec2> to;
    for (const int q : around) to.push_back(points[std::size_t(q)] - points[std::size_t(p)]);
    const std::vector<Vec2> weight = gradient_stencil(to);
    if (weight.empty()) return g;
    Vec2 sum = Vec2::Zero();
    for (const Vec2& w : weight) sum += w;
    g.points = {p};
    g.weight = {-sum};
    g.points.insert(g.points.end(), around.begin(), around.end());
    g.weight.insert(g.weight.end(), weight.begin(), weight.end());
    return g;
  }

  void add_curving(Natural& place) const {
    if (mesh.dimension() != 2) return;
    std::vector<std::pair<int, double>> terms;
    for (const Natural::Share& s : place.shares) {
      const Gradient& g = gradient(s.point);
      if (g.points.empty()) return;
      for (std::size_t k = 0; k < g.points.size(); ++k)
        terms.emplace_back(g.points[k], 0.5 * s.weight * g.weight[k].dot(s.from));
    }
    std::stable_sort(terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t k = 0; k < terms.size();) {
      double sum = 0;
      const int point = terms[k].first;
      for (; k < terms.size() && terms[k].first == point; ++k) sum += terms[k].second;
      if (std::abs(sum) > round_off) place.curving.push_back({point, sum});
    }
  }
  static constexpr double round_off = 1e-9;

  mutable std::vector<Gradient> gradients;
  mutable std::vector<Delaunay::Vertex_handle> handles;
  // Buffers of sibson().
  mutable std::vector<Delaunay::Face_handle> taken;
  mutable std::vector<Delaunay::Edge> hole;
  mutable std::vector<std::pair<Delaunay::Vertex_handle, double>> areas;
};

MaterialMesh::MaterialMesh(std::vector<Vec2> points, std::vector<double> spacing) : impl_(std::make_unique<Impl>()) {
  assert(points.size() == spacing.size());
  impl_->points = std::move(points);
  impl_->spacing = std::move(spacing);
  impl_->mesh = triangulate(impl_->points);
  if (impl_->mesh.dimension() == 2) impl_->keep_triangles();
  impl_->find_boundary();
  impl_->index_boundary();
}
MaterialMesh::~MaterialMesh() = default;
MaterialMesh::MaterialMesh(MaterialMesh&&) noexcept = default;
MaterialMesh& MaterialMesh::operator=(MaterialMesh&&) noexcept = default;

const std::vector<Vec2>& MaterialMesh::points() const { return impl_->points; }
const std::vector<std::array<int, 3>>& MaterialMesh::triangles() const { return impl_->triangles; }
const std::vector<std::array<int, 2>>& MaterialMesh::boundary() const { return impl_->boundary; }

std::optional<Location> MaterialMesh::find(const Vec2& x) const {
  if (impl_->mesh.dimension() == 2) {
    const auto face = impl_->mesh.locate(Point(x.x(), x.y()), impl_->hint);
    impl_->hint = face;
    if (face->info() >= 0) return impl_->inside(impl_->triangles[std::size_t(face->info())], x);
  }
  // Also points that lie on a side, or a point, shared by a triangle kept and one that is not: at distance zero.
  const NearestEdge::Hit hit = impl_->nearest.find(x);
  if (hit.edge < 0) return std::nullopt;
  const auto [a, b] = impl_->boundary[std::size_t(hit.edge)];
  const Vec2 foot = impl_->points[std::size_t(a)] +
                    hit.parameter * (impl_->points[std::size_t(b)] - impl_->points[std::size_t(a)]);
  return Location{{a, b, -1}, {1 - hit.parameter, hit.parameter, 0}, x - foot};
}

std::optional<Natural> MaterialMesh::find_natural(const Vec2& x) const {
  const auto linear = find(x);
  if (!linear) return std::nullopt;
  Natural out;
  out.beyond = linear->beyond;
  if (impl_->mesh.dimension() == 2 && impl_->hint->info() >= 0) out.shares = impl_->sibson(x, impl_->hint);
  if (out.shares.empty())
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(linear->weight[k] > 0)) continue;
      const Vec2& at = impl_->points[std::size_t(linear->vertex[k])];
      out.shares.push_back({linear->vertex[k], linear->weight[k], x - linear->beyond - at});
    }
  impl_->add_curving(out);
  return out;
}

bool Natural::rests_on(const std::vector<std::uint8_t>& marked) const {
  const auto is = [&](const auto& part) { return marked[std::size_t(part.point)] != 0; };
  return std::all_of(shares.begin(), shares.end(), is) && std::all_of(curving.begin(), curving.end(), is);
}

void Natural::renumber(const std::vector<int>& index) {
  for (Share& s : shares) s.point = index[std::size_t(s.point)];
  for (Term& t : curving) t.point = index[std::size_t(t.point)];
}

double median_neighbour_distance(const std::vector<Vec2>& points) {
  const Delaunay mesh = triangulate(points);
  std::vector<double> nearest(points.size(), std::numeric_limits<double>::infinity());
  // The nearest neighbour of a point is joined to it by a Delaunay edge.
  for (auto edge = mesh.finite_edges_begin(); edge != mesh.finite_edges_end(); ++edge) {
    const auto [face, k] = *edge;
    const int a = face->vertex(mesh.dimension() == 2 ? mesh.ccw(k) : 0)->info();
    const int b = face->vertex(mesh.dimension() == 2 ? mesh.cw(k) : 1)->info();
    const double length = (points[std::size_t(a)] - points[std::size_t(b)]).norm();
    nearest[std::size_t(a)] = std::min(nearest[std::size_t(a)], length);
    nearest[std::size_t(b)] = std::min(nearest[std::size_t(b)], length);
  }
  std::erase_if(nearest, [](double d) { return !std::isfinite(d); });
  if (nearest.empty()) return 0;
  const auto middle = nearest.begin() + std::ptrdiff_t(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

}  // namespace pivnp::compare

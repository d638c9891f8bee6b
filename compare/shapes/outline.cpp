#include "compare/shapes/outline.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "compare/data/nearest_edge.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

// Neighbours drift apart as the material stretches: by the greater principal stretch of F, followed up to four.
double present_spacing(double spacing, const Mat2& F) {
  const double stretch = std::exp(principal(log_strain(F)).first);
  return spacing * (std::isfinite(stretch) ? std::clamp(stretch, 1.0, 4.0) : 1.0);
}

struct Box {
  Vec2 lower = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 upper = Vec2::Constant(-std::numeric_limits<double>::infinity());

  void hold(const Vec2& x) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
};

void hold_triangles(const MaterialMesh& mesh, Box& box) {
  for (const auto& corner : mesh.triangles())
    for (int v : corner) box.hold(mesh.points()[std::size_t(v)]);
}

// Calls `visit(i, j)` for the cells whose centre lies in the box.
template <class Visit>
void cells_in(const Lattice& lattice, const Box& box, Visit&& visit) {
  const Vec2 low = (box.lower - lattice.first) / lattice.cell, high = (box.upper - lattice.first) / lattice.cell;
  const int i0 = std::max(0, int(std::ceil(low.x()))), i1 = std::min(lattice.nx - 1, int(std::floor(high.x())));
  const int j0 = std::max(0, int(std::ceil(low.y()))), j1 = std::min(lattice.ny - 1, int(std::floor(high.y())));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) visit(i, j);
}

}  // namespace

MaterialMesh present_mesh(const DataSet& set, const RigidMotion& frame) {
  std::vector<Vec2> x;
  std::vector<double> spacing;
  const bool moved = frame.angle != 0 || frame.shift != Vec2::Zero();
  for (std::size_t p = 0; p < set.size(); ++p) {
    if (!set.state().followed[p]) continue;
    const Vec2 place = set.material_position()[p] + set.state().u[p];
    x.push_back(moved ? frame.undo(place) : place);
    spacing.push_back(present_spacing(set.spacing()[p], set.state().F[p]));
  }
  return MaterialMesh(std::move(x), std::move(spacing));
}

Lattice lattice_around(const MaterialMesh& first, const MaterialMesh& second, double cell, double grow,
                       std::optional<double> base_y) {
  constexpr double most_cells = 1 << 22;
  Box box;
  hold_triangles(first, box);
  hold_triangles(second, box);
  if (box.lower.x() > box.upper.x()) return {};
  Lattice lattice;
  double nx, ny;
  for (lattice.cell = cell;; lattice.cell *= 1.25) {
    const Vec2 size = (box.upper - box.lower) + Vec2::Constant(2 * grow + 6 * lattice.cell);
    nx = std::ceil(size.x() / lattice.cell) + 1;
    ny = std::ceil(size.y() / lattice.cell) + 1;
    if (nx * ny <= most_cells) break;
  }
  lattice.nx = int(nx);
  lattice.ny = int(ny);
  lattice.first = box.lower - Vec2::Constant(grow + 3 * lattice.cell);
  if (base_y) {
    const double row = std::floor((lattice.first.y() - *base_y) / lattice.cell);
    lattice.first.y() = *base_y + (row + 0.5) * lattice.cell;  // down or up by at most half a cell
  }
  return lattice;
}

double Cover::share(std::size_t index) const { return std::clamp(0.5 + double(level[index]) / lattice.cell, 0.0, 1.0); }

Cover cover(const MaterialMesh& mesh, double grow, const Lattice& lattice) {
  Cover out{lattice, {}};
  const double band = 2 * lattice.cell;
  out.level.assign(std::size_t(lattice.nx) * std::size_t(lattice.ny), float(-band));
  const auto& x = mesh.points();
  for (const auto& corner : mesh.triangles()) {
    const Vec2 &a = x[std::size_t(corner[0])], &b = x[std::size_t(corner[1])], &c = x[std::size_t(corner[2])];
    Box box;
    for (const Vec2* p : {&a, &b, &c}) box.hold(*p);
    cells_in(lattice, box, [&](int i, int j) {
      const Vec2 p = lattice.centre(i, j);
      if (cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0)
        out.level[lattice.index(i, j)] = float(std::max(grow, lattice.cell));
    });
  }
  for (const auto& [first, second] : mesh.boundary()) {
    if (first == second) continue;
    const Vec2 &a = x[std::size_t(first)], &b = x[std::size_t(second)];
    Box box;
    for (const Vec2& p : {a, b}) {
      box.hold(p - Vec2::Constant(grow + band));
      box.hold(p + Vec2::Constant(grow + band));
    }
    cells_in(lattice, box, [&](int i, int j) {
      const Vec2 p = lattice.centre(i, j);
      const double distance = (p - (a + nearest_parameter(a, b, p) * (b - a))).norm();
      float& level = out.level[lattice.index(i, j)];
      level = std::max(level, float(grow - distance));
    });
  }
  return out;
}

Overlap overlap(const Cover& first, const Cover& second) {
  assert(first.level.size() == second.level.size());
  const double area = first.lattice.cell * first.lattice.cell;
  Overlap sum;
  for (std::size_t k = 0; k < first.level.size(); ++k) {
    const double a = first.share(k), b = second.share(k);
    sum.common += std::min(a, b) * area;
    sum.either += std::max(a, b) * area;
  }
  return sum;
}

namespace {

// A place where the zero line crosses the lattice: between (i, j) and its right (even) or upper (odd) neighbour.
using Crossing = std::int64_t;

struct Squares {
  const Cover& cover;

  bool inside(int i, int j) const { return cover.level[cover.lattice.index(i, j)] > 0; }

  // DataSet k of square (i, j): bottom, right, top, left.
  Crossing crossing(int i, int j, int k) const {
    const Lattice& l = cover.lattice;
    if (k == 0) return Crossing(2 * l.index(i, j));
    if (k == 1) return Crossing(2 * l.index(i + 1, j) + 1);
    if (k == 2) return Crossing(2 * l.index(i, j + 1));
    return Crossing(2 * l.index(i, j) + 1);
  }

  Vec2 place(Crossing crossing) const {
    const Lattice& l = cover.lattice;
    const std::size_t at = std::size_t(crossing / 2);
    const int i = int(at % std::size_t(l.nx)), j = int(at / std::size_t(l.nx));
    const bool up = crossing % 2 != 0;
    const double a = double(cover.level[at]), b = double(cover.level[l.index(i + !up, j + up)]);
    const Vec2 step = up ? Vec2(0, 1) : Vec2(1, 0);
    return l.centre(i, j) + (a / (a - b)) * l.cell * step;
  }

  // Segments of one square, each from where the walk round it leaves the material to where it enters: material left.
  template <class Add>
  void segments(int i, int j, Add&& add) const {
    const std::array<bool, 4> in{inside(i, j), inside(i + 1, j), inside(i + 1, j + 1), inside(i, j + 1)};
    std::array<int, 2> leaves{}, enters{};
    int count = 0, entered = 0;
    for (int k = 0; k < 4; ++k) {
      const bool here = in[std::size_t(k)], next = in[std::size_t((k + 1) % 4)];
      if (here && !next) leaves[std::size_t(count++)] = k;
      if (!here && next) enters[std::size_t(entered++)] = k;
    }
    if (count == 1) add(crossing(i, j, leaves[0]), crossing(i, j, enters[0]));
    if (count != 2) return;
    const Lattice& l = cover.lattice;  // a saddle: what the middle is decides
    const float middle = cover.level[l.index(i, j)] + cover.level[l.index(i + 1, j)] +
                         cover.level[l.index(i + 1, j + 1)] + cover.level[l.index(i, j + 1)];
    const int turn = middle > 0 ? 1 : 3;
    for (int k : leaves) add(crossing(i, j, k), crossing(i, j, (k + turn) % 4));
  }
};

}  // namespace

std::vector<std::vector<Vec2>> outline(const Cover& cover) {
  const Squares squares{cover};
  std::vector<Crossing> starts;
  std::unordered_map<Crossing, Crossing> next;
  for (int j = 0; j + 1 < cover.lattice.ny; ++j)
    for (int i = 0; i + 1 < cover.lattice.nx; ++i)
      squares.segments(i, j, [&](Crossing from, Crossing to) {
        starts.push_back(from);
        next.emplace(from, to);
      });

  std::vector<std::vector<Vec2>> rings;
  for (Crossing start : starts) {
    auto it = next.find(start);
    if (it == next.end()) continue;  // part of a ring already
    std::vector<Vec2> ring{squares.place(start)};
    while (it != next.end()) {
      const Crossing to = it->second;
      next.erase(it);
      ring.push_back(squares.place(to));
      it = next.find(to);
    }
    rings.push_back(std::move(ring));
  }
  return rings;
}

double length_of(const std::vector<std::vector<Vec2>>& rings) {
  double length = 0;
  for (const auto& ring : rings)
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) length += (ring[k + 1] - ring[k]).norm();
  return length;
}

std::vector<Vec2> points_along(const std::vector<std::vector<Vec2>>& rings, double step) {
  std::vector<Vec2> points;
  for (const auto& ring : rings)
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      const Vec2 side = ring[k + 1] - ring[k];
      const int pieces = std::max(1, int(std::ceil(side.norm() / step)));
      for (int j = 0; j < pieces; ++j) points.push_back(ring[k] + (double(j) / pieces) * side);
    }
  return points;
}

}  // namespace pivnp::compare

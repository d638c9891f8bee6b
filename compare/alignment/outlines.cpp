#include "compare/alignment/outlines.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "compare/data/nearest_edge.hpp"
#include "compare/shapes/outline.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::compare {

namespace {

using Vec3 = Eigen::Vector3d;  // shift x, y and turn times the points' radius
using Mat3 = Eigen::Matrix3d;

std::vector<Vec2> points_on(const Rings& rings, double step, const Points& zone) {
  std::optional<Polygon> inside;
  if (!zone.empty()) {
    std::vector<Vec2> vertices = positions_of(zone);
    inside.emplace(std::move(vertices), "compare.fixed_zone_m");
  }
  std::vector<Vec2> points;
  for (const Vec2& x : points_along(rings, step))
    if (!inside || inside->contains(x)) points.push_back(x);
  constexpr std::size_t most = 2000;
  const std::size_t stride = points.size() / most + 1;
  std::vector<Vec2> out;
  for (std::size_t k = 0; k < points.size(); k += stride) out.push_back(points[k]);
  return out;
}

// How a point sees the other outline: distance along its normal, and what a small motion does to that.
struct Sight {
  double distance = 0;
  Vec3 row = Vec3::Zero();
};

Sight look(const Vec2& x, const Vec2& centre, double radius, const Rings& rings) {
  double nearest = std::numeric_limits<double>::infinity();
  Vec2 foot = Vec2::Zero(), along = Vec2::Zero();
  for (const auto& ring : rings)
    for (std::size_t k = 0; k + 1 < ring.size(); ++k) {
      const Vec2 on = ring[k] + nearest_parameter(ring[k], ring[k + 1], x) * (ring[k + 1] - ring[k]);
      const double d = (x - on).squaredNorm();
      if (d >= nearest) continue;
      nearest = d, foot = on, along = ring[k + 1] - ring[k];
    }
  const Vec2 normal = Vec2(along.y(), -along.x()).normalized(), arm = x - centre;
  return {normal.dot(x - foot), Vec3(normal.x(), normal.y(), (normal.y() * arm.x() - normal.x() * arm.y()) / radius)};
}

struct Normal {
  Mat3 matrix = Mat3::Zero();
  Vec3 right = Vec3::Zero();

  void add(const Sight& s) {
    matrix += s.row * s.row.transpose();
    right -= s.distance * s.row;
  }
  Vec3 solve() const { return matrix.ldlt().solve(right); }
};

// Sights worth counting: within three medians of the size of the distance.
std::vector<Sight> trimmed(std::vector<Sight> sights, double least) {
  std::vector<double> size;
  for (const Sight& s : sights) size.push_back(std::abs(s.distance));
  const auto middle = size.begin() + std::ptrdiff_t(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  const double most = std::max(3 * *middle, least);
  std::erase_if(sights, [&](const Sight& s) { return std::abs(s.distance) > most; });
  return sights;
}

}  // namespace

RigidFit match_outlines(const Rings& first, const Rings& second, double step, const Points& zone, const Vec2& start) {
  const std::vector<Vec2> points = points_on(first, step, zone);
  if (points.size() < 16)
    throw InputError("compare.space_alignment: found " + std::to_string(points.size()) +
                     " points of the first's outline to match, expected at least 16");
  Vec2 centre = Vec2::Zero();
  for (const Vec2& x : points) centre += x / double(points.size());
  double radius = 0;
  for (const Vec2& x : points) radius = std::max(radius, (x - centre).norm());

  // The motion of the first's points onto the second's outline; its inverse is asked for.
  RigidMotion there{centre, -start, 0};
  std::vector<Sight> sights;
  Normal normal;
  double last = std::numeric_limits<double>::infinity();
  for (int n = 0; n < 100 && last > 1e-6 * step; ++n) {
    sights.clear();
    for (const Vec2& x : points) sights.push_back(look(there.apply(x), centre + there.shift, radius, second));
    sights = trimmed(std::move(sights), step);
    normal = Normal();
    for (const Sight& s : sights) normal.add(s);
    const Vec3 held = Eigen::SelfAdjointEigenSolver<Mat3>(normal.matrix).eigenvalues();
    if (!(held.minCoeff() > 1e-3 * double(sights.size())))
      throw InputError("compare.space_alignment: the outline does not fix a shift in both directions and a rotation, "
                       "expected edges or corners that do");
    const Vec3 change = normal.solve();
    there.shift += Vec2(change.x(), change.y());
    there.angle += change.z() / radius;
    last = change.norm();
  }
  if (!(last <= 1e-3 * step)) throw InputError("compare.space_alignment: the fit of the outlines does not converge");

  Vec3 mean = Vec3::Zero(), square = Vec3::Zero();
  constexpr std::size_t pieces = 16;
  std::vector<Vec3> left_out;
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    Normal rest = normal;
    for (std::size_t k = piece * sights.size() / pieces; k < (piece + 1) * sights.size() / pieces; ++k) {
      rest.matrix -= sights[k].row * sights[k].row.transpose();
      rest.right += sights[k].distance * sights[k].row;
    }
    left_out.push_back(rest.solve());
    mean += left_out.back() / double(pieces);
  }
  for (const Vec3& x : left_out) square += (x - mean).cwiseAbs2();
  const Vec3 sigma = (square * (double(pieces - 1) / double(pieces))).cwiseSqrt();

  // x -> undo(x), written as a motion about the centre of the second's part.
  RigidFit fit;
  fit.motion.centre = centre + there.shift;
  fit.motion.angle = -there.angle;
  fit.motion.shift = -there.shift;
  fit.sigma_shift = Vec2(sigma.x(), sigma.y());
  fit.sigma_angle = sigma.z() / radius;
  return fit;
}

namespace {

struct Shape {
  Rings outline;
  Vec2 centre = Vec2::Zero();
  double cell = 0;
};

Shape shape_of(const DataSet& set) {
  const MaterialMesh mesh = present_mesh(set, {});
  const double spacing = set.median_spacing();
  const Cover covered = cover(mesh, spacing / 2, lattice_around(mesh, mesh, spacing / 4, spacing / 2, std::nullopt));
  Shape shape{outline(covered), Vec2::Zero(), covered.lattice.cell};
  double area = 0;
  for (int j = 0; j < covered.lattice.ny; ++j)
    for (int i = 0; i < covered.lattice.nx; ++i) {
      const double share = covered.share(covered.lattice.index(i, j));
      shape.centre += share * covered.lattice.centre(i, j);
      area += share;
    }
  shape.centre /= area;
  return shape;
}

}  // namespace

RigidFit match_data_sets(const DataSet& first, const DataSet& second, const Points& zone) {
  const Shape a = shape_of(first), b = shape_of(second);
  return match_outlines(a.outline, b.outline, std::max(a.cell, b.cell), zone,
                        zone.empty() ? Vec2(a.centre - b.centre) : Vec2(Vec2::Zero()));
}

}  // namespace pivnp::compare

// How a particle reads linear triangles: an affine field each, continuous across their sides.
#pragma once

#include <vector>

#include "pivnp/np/gather.hpp"
#include "pivnp/np/triangulation.hpp"

namespace pivnp::np {

/// Vectors at nodes of any place.
struct Scattered {
  Anchor anchor = Anchor::central;
  std::vector<Vec2> place;
  std::vector<std::array<double, 2>> displacement;
  std::vector<VectorStatus> status;
  std::vector<std::array<float, 3>> cov;  // empty: not known
};

class TriangleGather {
 public:
  /// Triangles of the usable nodes of `nodes`. A triangle with a side above `longest` holds no field; one with a side
  /// above `usual` bridges lost nodes: the reading then counts as a fit.
  TriangleGather(const Scattered& nodes, double usual, double longest, double error_correlation)
      : mesh_(usable_places(nodes)), correlation_(error_correlation), known_(!nodes.cov.empty()) {
    std::vector<std::size_t> used;
    for (std::size_t n = 0; n < nodes.place.size(); ++n)
      if (good(nodes, n)) used.push_back(n);
    fields_.reserve(mesh_.triangles().size());
    for (const Triangulation::Triangle& t : mesh_.triangles()) {
      Field f;
      std::array<std::size_t, 3> n;
      for (std::size_t k = 0; k < 3; ++k) n[k] = used[std::size_t(t.node[k])];
      const Vec2 a = nodes.place[n[0]], ab = nodes.place[n[1]] - a, ac = nodes.place[n[2]] - a;
      const double area = ab.x() * ac.y() - ab.y() * ac.x();
      const auto& d = nodes.displacement;
      f.a = a;
      f.d = {d[n[0]][0], d[n[0]][1]};
      f.to_second = Vec2(ac.y(), -ac.x()) / area;  // barycentric coordinates of the second and the third node
      f.to_third = Vec2(-ab.y(), ab.x()) / area;
      for (int q = 0; q < 2; ++q) {
        const auto c = std::size_t(q);
        f.G.row(q) = (d[n[1]][c] - d[n[0]][c]) * f.to_second.transpose() +
                     (d[n[2]][c] - d[n[0]][c]) * f.to_third.transpose();
      }
      f.support = Support::measured;
      for (std::size_t k = 0; k < 3; ++k) {
        if (nodes.status[n[k]] == VectorStatus::replaced) f.support = Support::replaced;
        if (known_) f.cov[k] = nodes.cov[n[k]];
      }
      if (t.longest > usual) f.support = Support::fitted;
      if (t.longest > longest || !(area > 0)) f.support = Support::none;
      fields_.push_back(f);
    }
  }

  Reading forward(const Vec2& x) const {
    const int t = mesh_.locate(x);
    return t < 0 ? nothing() : read(fields_[std::size_t(t)], x);
  }

  Reading central(const Vec2& x) const {
    Vec2 m = x;
    for (int n = 0; n < 50; ++n) {
      const int t = mesh_.locate(m);
      if (t < 0 || fields_[std::size_t(t)].support == Support::none) return nothing();
      const Field& f = fields_[std::size_t(t)];
      const Vec2 left = x + 0.5 * (f.d + f.G * (m - f.a)) - m;
      if (n > 0 && left.norm() <= 1e-14 * f.size() + 1e-15 * x.norm()) return read(f, m);
      const Mat2 A = Mat2::Identity() - 0.5 * f.G;  // an affine field: Newton's step is the answer within the triangle
      const double det = A(0, 0) * A(1, 1) - A(0, 1) * A(1, 0);
      if (n < 12 && det > 0.05)
        m += Vec2(A(1, 1) * left.x() - A(0, 1) * left.y(), A(0, 0) * left.y() - A(1, 0) * left.x()) / det;
      else
        m += left;
    }
    Reading r = forward(m);
    if (r.outcome == Outcome::good) r.outcome = Outcome::unsettled;
    return r;
  }

 private:
  struct Field {
    Support support;
    Vec2 a, d, to_second, to_third;
    Mat2 G;
    std::array<std::array<float, 3>, 3> cov{};
    double size() const { return 1 / (to_second.norm() + to_third.norm()); }
  };

  static bool good(const Scattered& nodes, std::size_t n) {
    const auto& d = nodes.displacement[n];
    return usable(nodes.status[n]) && std::isfinite(d[0]) && std::isfinite(d[1]);
  }
  static std::vector<Vec2> usable_places(const Scattered& nodes) {
    std::vector<Vec2> places;
    for (std::size_t n = 0; n < nodes.place.size(); ++n)
      if (good(nodes, n)) places.push_back(nodes.place[n]);
    return places;
  }
  static Reading nothing() {
    Reading r;
    r.outcome = Outcome::no_vectors;
    return r;
  }

  Reading read(const Field& f, const Vec2& x) const {
    if (f.support == Support::none) return nothing();
    Reading r;
    r.support = f.support;
    const Vec2 d = f.d + f.G * (x - f.a);
    r.dx = d.x(), r.dy = d.y();
    r.gxx = f.G(0, 0), r.gxy = f.G(0, 1), r.gyx = f.G(1, 0), r.gyy = f.G(1, 1);
    if (!known_) return r;
    const double second = f.to_second.dot(x - f.a), third = f.to_third.dot(x - f.a);
    const std::array<double, 3> w{1 - second - third, second, third};
    double sum = 0;
    for (const double v : w) sum += std::abs(v);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        r.cov[c] += (correlation_ * sum * std::abs(w[k]) + (1 - correlation_) * w[k] * w[k]) * double(f.cov[k][c]);
    r.gradient_variance = 0.5 * (r.cov[0] + r.cov[1]) * (f.to_second.squaredNorm() + f.to_third.squaredNorm());
    return r;
  }

  Triangulation mesh_;
  std::vector<Field> fields_;
  double correlation_;
  bool known_;
};

/// Triangles on the grid's own nodes; a particle that no triangle holds reads as Gather does (the local fit reaches a
/// little beyond the hull).
template <class Real>
class GridTriangles {
 public:
  GridTriangles(const Nodes<Real>& nodes, const SupportMap& support, bool centre_gradient, double error_correlation)
      : nodes_(nodes), plain_(nodes, support, centre_gradient, error_correlation),
        triangles_(scattered(nodes), 1.1 * nodes.grid.spacing.norm(), 4 * nodes.grid.spacing.maxCoeff(),
                   error_correlation) {}
  Reading forward(const Vec2& x) const {
    const Reading r = triangles_.forward(x);
    return r.outcome == Outcome::no_vectors ? plain_.forward(x) : with_errors(x, r);
  }
  Reading central(const Vec2& x) const {
    const Reading r = triangles_.central(x);
    return r.outcome == Outcome::no_vectors ? plain_.central(x) : with_errors(x + 0.5 * Vec2(r.dx, r.dy), r);
  }

 private:
  Reading with_errors(const Vec2& at, Reading r) const {
    if (nodes_.errors == nullptr) return r;
    const Vec2 s = (at - nodes_.grid.origin).cwiseQuotient(nodes_.grid.spacing);
    const int i = std::clamp(int(s.x()), 0, nodes_.grid.nx - 2), j = std::clamp(int(s.y()), 0, nodes_.grid.ny - 2);
    const std::array<double, 3> cov = r.cov;
    read_errors(nodes_, i, j, 1, 1, r);
    r.cov = cov;
    return r;
  }

  static Scattered scattered(const Nodes<Real>& nodes) {
    Scattered out;
    const std::size_t count = nodes.grid.node_count();
    for (int j = 0; j < nodes.grid.ny; ++j)
      for (int i = 0; i < nodes.grid.nx; ++i) out.place.push_back(nodes.grid.position(i, j));
    for (std::size_t n = 0; n < count; ++n)
      out.displacement.push_back({double(nodes.displacement[n][0]), double(nodes.displacement[n][1])});
    out.status.assign(nodes.status, nodes.status + count);
    if (nodes.cov != nullptr) out.cov.assign(nodes.cov, nodes.cov + count);
    for (std::size_t n = 0; nodes.path_factor != nullptr && n < out.cov.size(); ++n)
      for (float& c : out.cov[n]) c *= nodes.path_factor[n];
    return out;
  }
  Nodes<Real> nodes_;
  Gather<Real> plain_;
  TriangleGather triangles_;
};

}  // namespace pivnp::np

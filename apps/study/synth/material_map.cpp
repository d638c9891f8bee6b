#include "apps/study/synth/material_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::app {

namespace {

constexpr double weight_reach = 1.7, gradient_reach = 2.3;  // spacings

double median_spacing(const ParticleSet& points) {
  std::vector<double> area = points.area;
  if (area.empty()) throw InputError("synth: the motion that carries the texture has no material points");
  std::nth_element(area.begin(), area.begin() + std::ptrdiff_t(area.size() / 2), area.end());
  const double middle = area[area.size() / 2];
  if (!(middle > 0)) throw InputError("synth: the material points that carry the texture have no area, expected areas above 0");
  return std::sqrt(middle);
}

}  // namespace

MaterialMap::MaterialMap(const ParticleSet& points)
    : X_(points.x0), label_(points.label), spacing_(median_spacing(points)) {
  Vec2 upper = X_.front();
  lower_ = X_.front();
  for (const Vec2& x : X_) lower_ = lower_.cwiseMin(x), upper = upper.cwiseMax(x);
  const double cell = gradient_reach * spacing_;
  nx_ = 1 + int((upper.x() - lower_.x()) / cell);
  ny_ = 1 + int((upper.y() - lower_.y()) / cell);
  cells_.resize(std::size_t(nx_) * std::size_t(ny_));
  for (std::size_t p = 0; p < X_.size(); ++p) {
    const Vec2 at = (X_[p] - lower_) / cell;
    cells_[std::size_t(int(at.y())) * std::size_t(nx_) + std::size_t(int(at.x()))].push_back(std::uint32_t(p));
  }
  neighbours_.resize(X_.size());
  for (std::size_t p = 0; p < X_.size(); ++p) {
    neighbours_[p] = around(X_[p], cell);
    std::erase_if(neighbours_[p], [&](std::uint32_t q) { return q == p || label_[q] != label_[p]; });
  }
}

std::vector<std::uint32_t> MaterialMap::around(const Vec2& X, double reach) const {
  const Vec2 at = (X - lower_) / (gradient_reach * spacing_);
  std::vector<std::uint32_t> found;
  if (!(at.x() > -2 && at.y() > -2 && at.x() < nx_ + 1 && at.y() < ny_ + 1)) return found;
  const int i = int(std::floor(at.x())), j = int(std::floor(at.y()));
  for (int b = std::max(0, j - 1); b <= std::min(ny_ - 1, j + 1); ++b)
    for (int a = std::max(0, i - 1); a <= std::min(nx_ - 1, i + 1); ++a)
      for (const std::uint32_t p : cells_[std::size_t(b) * std::size_t(nx_) + std::size_t(a)])
        if ((X_[p] - X).norm() < reach) found.push_back(p);
  return found;
}

std::optional<MaterialMap::Stencil> MaterialMap::stencil(const Vec2& X) const {
  const double R = weight_reach * spacing_;
  std::vector<std::uint32_t> near = around(X, R);
  if (near.empty()) return std::nullopt;
  const std::uint32_t nearest = *std::min_element(
      near.begin(), near.end(), [&](auto a, auto b) { return (X_[a] - X).squaredNorm() < (X_[b] - X).squaredNorm(); });
  Stencil s{X, {}, {}};
  for (const std::uint32_t p : near) {
    if (label_[p] != label_[nearest]) continue;
    const double r = (X_[p] - X).norm();
    if (r < 1e-9 * spacing_) return Stencil{X, {p}, {1}};
    const double w = (R - r) * spacing_ / (R * r);
    s.point.push_back(p);
    s.weight.push_back(w * w);
  }
  return s;
}

void MaterialMap::set(const MotionFrame& frame) {
  const std::size_t n = X_.size();
  u_.resize(n);
  F_.resize(n);
  followed_.resize(n);
  G_.assign(n, Mat2::Zero());
  for (std::size_t p = 0; p < n; ++p) {
    u_[p] = {double(frame.u[p][0]), double(frame.u[p][1])};
    F_[p] = matrix(frame.F[p]);
    followed_[p] = alive(frame.status[p]);
  }
  for (std::size_t p = 0; p < n; ++p) {
    if (!followed_[p]) continue;
    Mat2 A = Mat2::Zero(), B = Mat2::Zero();
    for (const std::uint32_t q : neighbours_[p]) {
      if (!followed_[q]) continue;
      const Vec2 d = X_[q] - X_[p];
      const double w = 1 / d.squaredNorm();
      A += w * d * d.transpose();
      B += w * (u_[q] - u_[p]) * d.transpose();
    }
    // A row of points, or one alone, does not tell its gradient.
    const bool told = A.determinant() > 1e-3 * A.trace() * A.trace();
    G_[p] = told ? Mat2(B * A.inverse()) : Mat2(F_[p] - Mat2::Identity());
  }
}

Vec2 MaterialMap::at(const Stencil& s) const {
  Vec2 sum = Vec2::Zero();
  double total = 0;
  for (std::size_t k = 0; k < s.point.size(); ++k) {
    const std::uint32_t p = s.point[k];
    if (!followed_[p]) continue;
    sum += s.weight[k] * (u_[p] + G_[p] * (s.X - X_[p]));
    total += s.weight[k];
  }
  if (!(total > 0)) return Vec2::Constant(std::numeric_limits<double>::quiet_NaN());
  return s.X + sum / total;
}

Mat2 MaterialMap::F(const Stencil& s) const {
  Mat2 sum = Mat2::Zero();
  double total = 0;
  for (std::size_t k = 0; k < s.point.size(); ++k) {
    if (!followed_[s.point[k]]) continue;
    sum += s.weight[k] * F_[s.point[k]];
    total += s.weight[k];
  }
  return total > 0 ? Mat2(sum / total) : Mat2(Mat2::Identity());
}

}  // namespace pivnp::app

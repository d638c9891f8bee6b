#include "pivnp/np/analytic.hpp"

#include <Eigen/LU>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace pivnp::np {

namespace {

Mat2 turned(double angle) {
  Mat2 R;
  R << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return R;
}

Vec2 quarter_turned(const Vec2& x) { return {-x.y(), x.x()}; }

}  // namespace

AffineMotion AffineMotion::extension(double rate, double fixed) {
  return AffineMotion([=](double t) {
    const double stretch = std::pow(1 + rate, t);
    return AffineMap{Vec2(stretch, 1).asDiagonal(), Vec2((1 - stretch) * fixed, 0)};
  });
}

AffineMotion AffineMotion::shear(double rate, double fixed) {
  return AffineMotion([=](double t) {
    AffineMap map;
    map.A(0, 1) = rate * t;
    map.b.x() = -rate * t * fixed;
    return map;
  });
}

AffineMotion AffineMotion::rotation(double angle_rate, const Vec2& centre, const Vec2& velocity) {
  return AffineMotion([=](double t) {
    const Mat2 R = turned(angle_rate * t);
    return AffineMap{R, centre + velocity * t - R * centre};
  });
}

AffineMap AffineMotion::step(double t0, double t1) const {
  const AffineMap from = map_(t0), to = map_(t1);
  const Mat2 A = to.A * from.A.inverse();
  return {A, to.b - A * from.b};
}

Vec2 AffineMotion::position(const Vec2& X, double t) const {
  const AffineMap s = step(0, t);
  return s.A * X + s.b;
}

Mat2 AffineMotion::deformation(const Vec2&, double t) const { return step(0, t).A; }

Vec2 AffineMotion::forward_increment(const Vec2& x, double t0, double t1) const {
  const AffineMap s = step(t0, t1);
  return (s.A - Mat2::Identity()) * x + s.b;
}

Vec2 AffineMotion::central_increment(const Vec2& xm, double t0, double t1) const {
  // xm = ((I + A) x0 + b) / 2
  const AffineMap s = step(t0, t1);
  const Vec2 x0 = (Mat2::Identity() + s.A).inverse() * (2 * xm - s.b);
  return (s.A - Mat2::Identity()) * x0 + s.b;
}

double ReversingVortex::angle(double r, double t) const {
  const double q = r / radius_;
  return turn_ * std::exp(-q * q) * std::sin(std::numbers::pi * t / period_);
}

Vec2 ReversingVortex::position(const Vec2& X, double t) const {
  const Vec2 r = X - centre_;
  return centre_ + turned(angle(r.norm(), t)) * r;
}

Mat2 ReversingVortex::deformation(const Vec2& X, double t) const {
  // dx = R dr + phi'(r) (W R r) (r . dr)/|r|, and phi' = -2 r/radius^2 phi.
  const Vec2 r = X - centre_;
  const double phi = angle(r.norm(), t);
  const Mat2 R = turned(phi);
  return R - (2 * phi / (radius_ * radius_)) * quarter_turned(R * r) * r.transpose();
}

Vec2 ReversingVortex::forward_increment(const Vec2& x, double t0, double t1) const {
  const Vec2 r = x - centre_;
  const double phi = angle(r.norm(), t1) - angle(r.norm(), t0);
  // (R - I) r without cancellation
  return -2 * std::pow(std::sin(phi / 2), 2) * r + std::sin(phi) * quarter_turned(r);
}

Vec2 ReversingVortex::central_increment(const Vec2& xm, double t0, double t1) const {
  const Vec2 m = xm - centre_;
  const double rho = m.norm();
  // r cos(phi(r)/2) = rho by Newton's method from r = rho.
  double r = rho, phi = 0;
  for (int n = 0; n < 60; ++n) {
    phi = angle(r, t1) - angle(r, t0);
    const double slope = std::cos(phi / 2) + r * r / (radius_ * radius_) * phi * std::sin(phi / 2);
    const double change = (rho - r * std::cos(phi / 2)) / slope;
    r += change;
    if (std::abs(change) <= 4 * std::numeric_limits<double>::epsilon() * r) break;
  }
  phi = angle(r, t1) - angle(r, t0);
  assert(std::abs(r * std::cos(phi / 2) - rho) <= 1e-12 * (radius_ + rho));
  return 2 * std::tan(phi / 2) * quarter_turned(m);
}

Vec2 ShearBand::position(const Vec2& X, double t) const { return X + forward_increment(X, 0, t); }

Mat2 ShearBand::deformation(const Vec2& X, double t) const {
  Mat2 F = Mat2::Identity();
  F(0, 1) = rate_ * t / std::pow(std::cosh((X.y() - middle_) / half_width_), 2);
  return F;
}

Vec2 ShearBand::forward_increment(const Vec2& x, double t0, double t1) const {
  return {rate_ * (t1 - t0) * half_width_ * std::tanh((x.y() - middle_) / half_width_), 0};
}

Vec2 ShearBand::central_increment(const Vec2& xm, double t0, double t1) const { return forward_increment(xm, t0, t1); }

NodalIncrements sample_increments(const AnalyticMotion& motion, const Grid& grid, Anchor anchor, double t0, double t1) {
  NodalIncrements out;
  out.anchor = anchor;
  out.grid = grid;
  out.displacement.reserve(grid.node_count());
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      const Vec2 x = grid.position(i, j);
      const Vec2 d = anchor == Anchor::central ? motion.central_increment(x, t0, t1)
                                               : motion.forward_increment(x, t0, t1);
      out.displacement.push_back({d.x(), d.y()});
    }
  out.status.assign(grid.node_count(), VectorStatus::valid);
  return out;
}

VectorField vector_field(const NodalIncrements& increments, std::array<int, 2> pair) {
  VectorField out;
  out.pair = pair;
  out.anchor = increments.anchor;
  out.grid = increments.grid;
  out.status = increments.status;
  out.cov = increments.cov;
  for (const auto& d : increments.displacement) out.displacement.push_back({float(d[0]), float(d[1])});
  for (const VectorStatus s : increments.status)
    out.score.push_back(usable(s) ? 1.0f : std::numeric_limits<float>::quiet_NaN());
  return out;
}

}  // namespace pivnp::np

#include "pivnp/image/camera/lens.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::image {

namespace {

constexpr double steepest = 89 * std::numbers::pi / 180;
constexpr int iterations = 50;

Vec2 nowhere() { return Vec2::Constant(nan_value); }

}  // namespace

Lens::Lens(LensModel model, const Vec2& focal_px, const Vec2& centre_px, std::vector<double> coefficients, const Window& window)
    : model_(model), focal_(focal_px), centre_(centre_px), k_(std::move(coefficients)), window_(window) {
  if (!(focal_.x() > 0 && focal_.y() > 0) || !focal_.allFinite())
    throw InputError("camera.focal_px: found " + number(focal_.x()) + ", " + number(focal_.y()) + ", expected two numbers above 0");
  const std::size_t most = model == LensModel::brown ? 5 : model == LensModel::fisheye ? 4 : 0;
  if (k_.size() > most)
    throw InputError("camera.distortion: found " + std::to_string(k_.size()) + " coefficients, expected at most " + std::to_string(most));
  k_.resize(most, 0.0);
  most_ = fold();
}

double Lens::fold() const {
  if (model_ == LensModel::none) return std::tan(steepest);
  const bool brown = model_ == LensModel::brown;
  const double end = brown ? std::tan(steepest) : steepest;
  const auto radius = [&](double t) {
    return brown ? t * (1 + t * t * (k_[0] + t * t * (k_[1] + t * t * k_[4]))) : bent(t);
  };
  double at = 0, step = 1e-3;
  for (double before = 0; at + step < end; at += step) {
    const double now = radius(at + step);
    if (!(now > before)) return at;
    before = now;
  }
  return end;
}

Vec2 Lens::distorted(const Vec2& ray) const {
  const double x = ray.x(), y = ray.y(), r2 = ray.squaredNorm();
  const double radial = 1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[4]));
  return {x * radial + 2 * k_[2] * x * y + k_[3] * (r2 + 2 * x * x), y * radial + k_[2] * (r2 + 2 * y * y) + 2 * k_[3] * x * y};
}

double Lens::bent(double angle) const {
  const double t2 = angle * angle;
  return angle * (1 + t2 * (k_[0] + t2 * (k_[1] + t2 * (k_[2] + t2 * k_[3]))));
}

double Lens::ratio(double tangent) const {
  const double sine2 = tangent * tangent / (1 + tangent * tangent), n = window_.index;
  const double through = std::sqrt((1 - sine2) / (n * n - sine2));  // tan t' / tan t
  return (window_.distance + window_.thickness * through) / (window_.distance + window_.thickness / n);
}

Vec2 Lens::to_ideal(const Vec2& pixel) const {
  if (straight()) return pixel;
  const Vec2 seen = (pixel - centre_).cwiseQuotient(focal_);
  Vec2 ray = seen;
  if (model_ == LensModel::brown) {
    // Newton's method on the distortion, from no distortion at all; steps that leave the range of use are halved.
    bool settled = false;
    if (ray.norm() > most_) ray *= 0.99 * most_ / ray.norm();
    for (int n = 0; n < iterations && !settled; ++n) {
      const double x = ray.x(), y = ray.y(), r2 = ray.squaredNorm();
      const double radial = 1 + r2 * (k_[0] + r2 * (k_[1] + r2 * k_[4]));
      const double slope = 2 * (k_[0] + r2 * (2 * k_[1] + 3 * r2 * k_[4]));  // d radial / d r2, times 2
      Mat2 J;
      J << radial + slope * x * x + 2 * k_[2] * y + 6 * k_[3] * x, slope * x * y + 2 * k_[2] * x + 2 * k_[3] * y,
          slope * x * y + 2 * k_[2] * x + 2 * k_[3] * y, radial + slope * y * y + 6 * k_[2] * y + 2 * k_[3] * x;
      Vec2 step = J.inverse() * (seen - distorted(ray));
      if (!step.allFinite()) return nowhere();
      while ((ray + step).norm() > most_) {
        step /= 2;
        if (step.norm() < 1e-12) return nowhere();
      }
      ray += step;
      settled = step.norm() < 1e-13 * (1 + ray.norm());
    }
    if ((distorted(ray) - seen).norm() > 1e-9) return nowhere();
  } else if (model_ == LensModel::fisheye) {
    const double radius = seen.norm();
    if (radius > bent(most_)) return nowhere();
    double low = 0, high = most_, angle = std::min(radius, most_);
    for (int n = 0; n < iterations; ++n) {  // Newton's method, kept between what is known too small and too great
      const double off = bent(angle) - radius, t2 = angle * angle;
      (off > 0 ? high : low) = angle;
      const double slope = 1 + t2 * (3 * k_[0] + t2 * (5 * k_[1] + t2 * (7 * k_[2] + t2 * 9 * k_[3])));
      double next = angle - off / slope;
      if (!(next >= low && next <= high)) next = (low + high) / 2;
      if (std::abs(next - angle) < 1e-15) break;
      angle = next;
    }
    if (radius > 0) ray = seen * (std::tan(angle) / radius);
  }
  if (window_.thickness > 0) ray *= ratio(ray.norm());
  return centre_ + focal_.cwiseProduct(ray);
}

Vec2 Lens::to_pixel(const Vec2& ideal) const {
  if (straight()) return ideal;
  Vec2 ray = (ideal - centre_).cwiseQuotient(focal_);
  if (!ray.allFinite()) return nowhere();
  if (window_.thickness > 0) {
    // r = t ratio(t), for t; the ratio falls slowly, so that the fixed point is found in a few steps.
    const double radius = ray.norm();
    double tangent = radius;
    for (int n = 0; n < iterations; ++n) {
      const double next = radius / ratio(tangent);
      if (std::abs(next - tangent) <= 1e-15 * (1 + next)) break;
      tangent = next;
    }
    if (radius > 0) ray *= tangent / radius;
  }
  if (model_ == LensModel::brown) {
    if (ray.norm() > most_) return nowhere();
    ray = distorted(ray);
  } else if (model_ == LensModel::fisheye) {
    const double tangent = ray.norm(), angle = std::atan(tangent);
    if (angle > most_) return nowhere();
    if (tangent > 0) ray *= bent(angle) / tangent;
  }
  return centre_ + focal_.cwiseProduct(ray);
}

Mat2 Lens::jacobian(const Vec2& pixel) const {
  if (straight()) return Mat2::Identity();
  constexpr double h = 0.05;  // px: curvature and rounding both below 1e-9
  Mat2 J;
  J.col(0) = (to_ideal(pixel + Vec2(h, 0)) - to_ideal(pixel - Vec2(h, 0))) / (2 * h);
  J.col(1) = (to_ideal(pixel + Vec2(0, h)) - to_ideal(pixel - Vec2(0, h))) / (2 * h);
  return J;
}

}  // namespace pivnp::image

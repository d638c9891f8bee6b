#include "compare/transformed.hpp"

#include <cmath>

namespace pivnp::compare {

namespace {

std::array<float, 2> pair(const Vec2& v) { return {float(v.x()), float(v.y())}; }
Vec2 vec(const std::array<float, 2>& v) { return {double(v[0]), double(v[1])}; }

}  // namespace

TransformedMotion::TransformedMotion(const MotionSource& motion, const Transform& transform)
    : motion_(&motion), transform_(transform), particles_(motion.particles()) {
  const double c = std::cos(transform.angle), s = std::sin(transform.angle);
  rotation_ << c, -s, s, c;
  const auto at = [&](double t) { return transform_.time_scale * t + transform_.time_offset; };
  for (Vec2& x : particles_.x0) x = transform_.scale * (rotation_ * x) + transform_.shift;
  for (double& a : particles_.area) a *= transform_.scale * transform_.scale;
  for (double& t : particles_.born) t = at(t);
  for (double& t : particles_.end) t = at(t);
  for (const double t : motion.times()) times_.push_back(at(t));
}

MotionFrame TransformedMotion::frame(std::size_t index) const {
  MotionFrame f = motion_->frame(index);
  f.time = times_.at(index);
  const double scale = transform_.scale;
  for (auto& u : f.u) u = pair(scale * (rotation_ * vec(u)));
  for (auto& v : f.v) v = pair(scale / transform_.time_scale * (rotation_ * vec(v)));
  if (transform_.angle != 0)
    for (auto& F : f.F) {
      Mat2 m;
      m << double(F[0]), double(F[1]), double(F[2]), double(F[3]);
      m = rotation_ * m * rotation_.transpose();
      F = {float(m(0, 0)), float(m(0, 1)), float(m(1, 0)), float(m(1, 1))};
    }
  const auto turned = [&](double xx, double yy, double xy, double by) {
    Mat2 m;
    m << xx, xy, xy, yy;
    return Mat2(by * (rotation_ * m * rotation_.transpose()));
  };
  for (auto& c : f.cov_u) {
    const Mat2 m = turned(double(c[0]), double(c[1]), double(c[2]), scale * scale);
    c = {float(m(0, 0)), float(m(1, 1)), float(m(0, 1))};
  }
  for (auto& t : f.stress) {
    const Mat2 m = turned(double(t[0]), double(t[1]), double(t[3]), 1);
    t = {float(m(0, 0)), float(m(1, 1)), t[2], float(m(0, 1))};
  }
  return f;
}

}  // namespace pivnp::compare

#include "compare/data/transformed.hpp"

#include <cmath>
#include <string_view>

#include "pivnp/core/particles/fields.hpp"

namespace pivnp::compare {

namespace {

std::array<float, 2> pair(const Vec2& v) { return {float(v.x()), float(v.y())}; }
Vec2 vec(const std::array<float, 2>& v) { return {double(v[0]), double(v[1])}; }

// What numbers of a unit in terms of L and T ("L^2/T") are multiplied with.
double factor(std::string_view unit, double length, double time) {
  double out = 1;
  bool below = false;
  for (std::size_t k = 0; k < unit.size(); ++k) {
    if (unit[k] == '/') below = true;
    if (unit[k] != 'L' && unit[k] != 'T') continue;
    const double base = unit[k] == 'L' ? length : time;
    const bool power = k + 2 < unit.size() && unit[k + 1] == '^';
    const double raised = power ? std::pow(base, unit[k + 2] - '0') : base;
    out *= below ? 1 / raised : raised;
  }
  return out;
}

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
  for (FieldValues& field : f.fields) {
    const double by = factor(field.field->unit, scale, transform_.time_scale);
    const std::size_t n = field.components;
    for (std::size_t k = 0; k < field.values.size(); k += n) {
      float* t = &field.values[k];
      switch (field.field->form) {
        case FieldForm::scalar: t[0] = float(by * double(t[0])); break;
        case FieldForm::code: break;
        case FieldForm::vector: {
          const Vec2 r = by * (rotation_ * Vec2(double(t[0]), double(t[1])));
          t[0] = float(r.x()), t[1] = float(r.y());
          break;
        }
        case FieldForm::tensor: {
          Mat2 m;
          m << double(t[0]), double(t[1]), double(t[2]), double(t[3]);
          m = by * (rotation_ * m * rotation_.transpose());
          t[0] = float(m(0, 0)), t[1] = float(m(0, 1)), t[2] = float(m(1, 0)), t[3] = float(m(1, 1));
          break;
        }
        case FieldForm::symmetric:
        case FieldForm::stress: {
          const Mat2 m = turned(double(t[0]), double(t[1]), double(t[n - 1]), by);
          if (n == 4) t[2] = float(by * double(t[2]));
          t[0] = float(m(0, 0)), t[1] = float(m(1, 1)), t[n - 1] = float(m(0, 1));
          break;
        }
      }
    }
  }
  return f;
}

}  // namespace pivnp::compare

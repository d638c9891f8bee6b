#include "mpm/scene/centrifuge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pivnp/core/error.hpp"
#include "pivnp/core/text.hpp"

namespace pivnp::mpm {

namespace {

double rad_s(double rpm) { return rpm * 2 * std::numbers::pi / 60; }

[[noreturn]] void refuse_centrifuge(const char* key, const std::string& what) { throw InputError(std::string("centrifuge.") + key + ": " + what); }

}  // namespace

Centrifuge::Centrifuge(const CentrifugeOptions& o, bool axisymmetric) : axis_(o.axis), centre_(o.at_m[0], o.at_m[1]) {
  const bool of_symmetry = axis_ == RotationAxis::symmetry;
  if (of_symmetry && !axisymmetric) refuse_centrifuge("axis", "found symmetry in a plane run, expected across or along (or mpm.geometry = \"axisymmetric\")");
  if (!of_symmetry && axisymmetric)
    refuse_centrifuge("axis", "found " + std::string(name_of(axis_)) + " in an axisymmetric run, which no such field leaves axisymmetric; expected symmetry (or mpm.gravity_m_s2 alone)");
  if (of_symmetry && o.radius_m) refuse_centrifuge("radius_m", "given beside axis = \"symmetry\", expected none");
  if (!of_symmetry && !o.radius_m) refuse_centrifuge("radius_m", "missing; expected the distance from the rotation axis to at_m, m");
  if (o.rate_rpm.has_value() == !o.rate_history.empty()) refuse_centrifuge("rate_rpm", "expected either rate_rpm or rate_history");
  if (axis_ != RotationAxis::across && o.coriolis.value_or(false))
    refuse_centrifuge("coriolis", "found true beside axis = \"" + std::string(name_of(axis_)) + "\", where it acts out of the plane; expected false or axis = \"across\"");
  if (axis_ != RotationAxis::across && o.euler)
    refuse_centrifuge("euler", "found true beside axis = \"" + std::string(name_of(axis_)) + "\", where it acts out of the plane; expected false or axis = \"across\"");
  if (!of_symmetry) centre_.y() += *o.radius_m;
  coriolis_ = o.coriolis.value_or(axis_ == RotationAxis::across);
  euler_ = o.euler;
  if (o.rate_rpm) {
    rates_ = {{0.0, rad_s(*o.rate_rpm)}};
    return;
  }
  for (const Pair& at : o.rate_history) {
    if (!rates_.empty() && !(at[0] > rates_.back().first))
      refuse_centrifuge("rate_history", "found the time " + number(at[0]) + " s after " + number(rates_.back().first) + " s, expected ascending times");
    rates_.emplace_back(at[0], rad_s(at[1]));
    if (at[0] > 0) changes_.push_back(at[0]);
  }
}

double Centrifuge::rate(double time) const {
  if (time <= rates_.front().first) return rates_.front().second;
  for (std::size_t k = 1; k < rates_.size(); ++k) {
    const auto& [from, before] = rates_[k - 1];
    const auto& [to, after] = rates_[k];
    if (time < to) return before + (time - from) / (to - from) * (after - before);
  }
  return rates_.back().second;
}

Vec2 Centrifuge::acceleration(const Vec2& x, double time) const {
  const double w = rate(time), w2 = w * w;
  switch (axis_) {
    case RotationAxis::along: return {0, w2 * (x.y() - centre_.y())};
    case RotationAxis::symmetry: return {w2 * x.x(), 0};
    case RotationAxis::across: break;
  }
  const Vec2 d = x - centre_;
  if (!euler_) return w2 * d;
  double change = 0;
  for (std::size_t k = 1; k < rates_.size(); ++k)
    if (time >= rates_[k - 1].first && time < rates_[k].first)
      change = (rates_[k].second - rates_[k - 1].second) / (rates_[k].first - rates_[k - 1].first);
  return w2 * d + change * Vec2(d.y(), -d.x());
}

// n = m + a J (v + n), J = (0 1; -1 0), with m the velocity without it.
Vec2 Centrifuge::turned(const Vec2& v, const Vec2& n, double a) {
  const double bx = n.x() + a * v.y(), by = n.y() - a * v.x(), per = 1 / (1 + a * a);
  return {per * (bx + a * by), per * (by - a * bx)};
}

double Centrifuge::greatest(const Vec2& x) const {
  double most = 0;
  for (const auto& [time, w] : rates_) most = std::max(most, acceleration(x, time).norm());
  return most;
}

}  // namespace pivnp::mpm

#include "compare/data/rigid.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace pivnp::compare {

namespace {

// Sums from which the fit follows; coordinates from a common origin so that differences keep their digits.
struct Sums {
  double n = 0;
  Vec2 X = Vec2::Zero(), x = Vec2::Zero();
  double dot = 0, cross = 0;  // of X and x

  void add(const Vec2& from, const Vec2& to) {
    n += 1;
    X += from;
    x += to;
    dot += from.dot(to);
    cross += from.x() * to.y() - from.y() * to.x();
  }
  Sums without(const Sums& b) const { return {n - b.n, X - b.X, x - b.x, dot - b.dot, cross - b.cross}; }
};

// The fit about `centre` (in the sums' coordinates).
RigidMotion solve(const Sums& s, const Vec2& centre, bool turn) {
  RigidMotion m;
  m.centre = centre;
  const Vec2 X = s.X / s.n, x = s.x / s.n;
  if (turn) {
    const double dot = s.dot - s.n * X.dot(x), cross = s.cross - s.n * (X.x() * x.y() - X.y() * x.x());
    if (dot != 0 || cross != 0) m.angle = std::atan2(cross, dot);
  }
  m.shift = x - centre - m.rotation() * (X - centre);
  return m;
}

}  // namespace

Mat2 RigidMotion::rotation() const {
  Mat2 R;
  const double c = std::cos(angle), s = std::sin(angle);
  R << c, -s, s, c;
  return R;
}

Vec2 RigidFit::variance_at(const Vec2& X) const {
  if (!sigma_shift.allFinite()) return Vec2::Zero();
  const double turn = std::isfinite(sigma_angle) ? sigma_angle : 0;
  const Vec2 arm = X - motion.centre;
  return {sigma_shift.x() * sigma_shift.x() + turn * turn * arm.y() * arm.y(),
          sigma_shift.y() * sigma_shift.y() + turn * turn * arm.x() * arm.x()};
}

RigidFit fit_rigid(const std::vector<Vec2>& X, const std::vector<Vec2>& x, bool turn) {
  assert(X.size() == x.size() && !X.empty());
  Vec2 lower = X[0], upper = X[0];
  for (const Vec2& p : X) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  const Vec2 origin = (lower + upper) / 2;
  constexpr int blocks = 4;
  std::array<Sums, blocks * blocks> block;
  const auto index = [&](double value, double low, double high) {
    return high > low ? std::clamp(int(blocks * (value - low) / (high - low)), 0, blocks - 1) : 0;
  };
  for (std::size_t p = 0; p < X.size(); ++p) {
    const int i = index(X[p].x(), lower.x(), upper.x()), j = index(X[p].y(), lower.y(), upper.y());
    block[std::size_t(j * blocks + i)].add(X[p] - origin, x[p] - origin);
  }
  Sums all;
  for (const Sums& b : block) {
    all.n += b.n;
    all.X += b.X;
    all.x += b.x;
    all.dot += b.dot;
    all.cross += b.cross;
  }
  const Vec2 centre = all.X / all.n;
  RigidFit fit;
  fit.motion = solve(all, centre, turn);

  std::vector<RigidMotion> left_out;
  for (const Sums& b : block)
    if (b.n > 0 && b.n < all.n) left_out.push_back(solve(all.without(b), centre, turn));
  const double count = double(left_out.size());
  if (count >= 4) {
    Vec2 mean = Vec2::Zero(), square = Vec2::Zero();
    double mean_angle = 0, square_angle = 0;
    for (const RigidMotion& m : left_out) {
      mean += m.shift / count;
      mean_angle += m.angle / count;
    }
    for (const RigidMotion& m : left_out) {
      square += (m.shift - mean).cwiseAbs2();
      square_angle += (m.angle - mean_angle) * (m.angle - mean_angle);
    }
    fit.sigma_shift = (square * ((count - 1) / count)).cwiseSqrt();
    fit.sigma_angle = turn ? std::sqrt(square_angle * (count - 1) / count) : 0;
  }
  fit.motion.centre += origin;
  return fit;
}

}  // namespace pivnp::compare

#include "apps/study/methods/paths/unseen_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pivnp/core/particles/alive.hpp"

namespace pivnp::app {

namespace {

Mat2 random_of(const np::Tracker::Particle& particle) {
  Mat2 m;
  m << particle.random[0], particle.random[2], particle.random[2], particle.random[1];
  return m;
}

}  // namespace

UnseenShares unseen_shares(double half_side, double alike) {
  if (!(alike > 0) || !(half_side > 0)) return {};
  // Both fits are even about the centre, where they weigh a place (x, y) of the square of half side 1 by
  //   A: 1,    Q: 1 + 15/4 (1/3 - x^2) + 15/4 (1/3 - y^2)     (over the mean; Legendre's polynomials)
  // The correlation is a product of one of x and one of y, so that means of two weights are sums of products along a
  // line.
  constexpr int places = 32;
  using Line = Eigen::Vector<double, places>;
  Line x, one = Line::Constant(1.0 / places);
  for (int k = 0; k < places; ++k) x[k] = (2 * k + 1.0) / places - 1;
  Line parabola = 15.0 / 4 * (1.0 / 3 - x.array().square());
  parabola.array() -= parabola.mean();
  parabola /= places;
  const double per = half_side / alike;
  const auto alike_at = [&](double d) { return std::exp(-0.5 * per * per * d * d); };
  Line to_centre;
  Eigen::Matrix<double, places, places> between;
  for (int k = 0; k < places; ++k) {
    to_centre[k] = alike_at(x[k]);
    for (int l = 0; l < places; ++l) between(k, l) = alike_at(x[k] - x[l]);
  }
  const double m = one.dot(to_centre), p = parabola.dot(to_centre);
  const double mm = one.dot(between * one), mp = one.dot(between * parabola), pp = parabola.dot(between * parabola);
  const double q0 = 2 * p * m;                                    // of q and e
  const double qq = 2 * pp * mm + 2 * mp * mp, qa = 2 * mp * mm;  // of q and q, q and A e
  const double a0 = m * m, aa = mm * mm;
  // r = e - A e - q
  return {qq, q0 - qa - qq, 1 + aa + qq - 2 * a0 - 2 * q0 + 2 * qa};
}

double paths_alike(const VectorField& field, double window) {
  if (!field.path_factor.empty()) return 7.2 / 32 * window;
  return double(field.correlation_length) / std::sqrt(2.0);
}

void UnseenError::add(const UnseenShares& shares, const Mat2& covariance) {
  bend += shares.bend * covariance, mixed += shares.mixed * covariance, beyond += shares.beyond * covariance;
}

Mat2 UnseenError::taken(const Mat2& S) const {
  const Mat2 cross = S * mixed;
  return bend + cross + cross.transpose() + S * beyond * S.transpose();
}

UnseenError UnseenError::carried(const Mat2& f) const {
  return {f * bend * f.transpose(), f * mixed * f.transpose(), f * beyond * f.transpose()};
}

UnseenError UnseenError::since(const UnseenError& before) const {
  return {bend - before.bend, mixed - before.mixed, beyond - before.beyond};
}

UnseenError UnseenError::with(const UnseenError& since) const {
  return {bend + since.bend, mixed + since.mixed, beyond + since.beyond};
}

void UnseenError::reduce(const Mat2& M) {
  mixed = M * mixed;
  beyond = M * beyond * M.transpose();
}

void UnseenErrors::grow(const np::Tracker& tracker, const np::BendLoss& lost, const UnseenShares& shares) {
  const auto state = tracker.state();
  for (std::size_t p = 0; p < std::min(marks_.size(), state.size()); ++p) {
    if (!alive(state.status(p))) continue;
    const np::Tracker::Particle now = state[p];
    const Mark& then = marks_[p];
    const Mat2 f = now.F * then.F.inverse(), more = random_of(now) - f * then.random * f.transpose();
    const Vec2 more_lost = lost.lost(p) - f * then.lost;
    errors_[p] = errors_[p].carried(f);
    const double left = more.trace() - more_lost.squaredNorm();
    if (left > 0) errors_[p].add(shares, left / more.trace() * more);
  }
  mark(tracker, lost);
}

void UnseenErrors::mark(const np::Tracker& tracker, const np::BendLoss& lost) {
  const auto state = tracker.state();
  errors_.resize(state.size());
  marks_.resize(state.size());
  for (std::size_t p = 0; p < state.size(); ++p) {
    const np::Tracker::Particle now = state[p];
    marks_[p] = {now.F, random_of(now), lost.lost(p)};
  }
}

}  // namespace pivnp::app

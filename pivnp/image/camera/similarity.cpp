#include "pivnp/image/camera/similarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pivnp::image {

namespace {

// x -> a x + b, in complex numbers as pairs: a = (ar, ai) turns and scales about the centre.
struct Plane {
  double ar = 1, ai = 0;
  Vec2 b = Vec2::Zero();

  Vec2 apply(const Vec2& x) const { return {ar * x.x() - ai * x.y() + b.x(), ai * x.x() + ar * x.y() + b.y()}; }
};

struct Sums {
  double weight = 0, spread = 0;  // sum of weights, of weighted squared distances from their mean
  Vec2 mean = Vec2::Zero();
};

// Weighted least squares; points as seen from the centre.
Plane solved(std::span<const RestPoint> points, const std::vector<double>& w, MotionModel model, const Vec2& centre,
             Sums& sums) {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  sums = {};
  for (std::size_t k = 0; k < points.size(); ++k) {
    sums.weight += w[k];
    from += w[k] * (points[k].from - centre);
    to += w[k] * (points[k].to - centre);
  }
  from /= sums.weight, to /= sums.weight;
  double dot = 0, turn = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec2 p = points[k].from - centre - from, q = points[k].to - centre - to;
    dot += w[k] * p.dot(q);
    turn += w[k] * (p.x() * q.y() - p.y() * q.x());
    sums.spread += w[k] * p.squaredNorm();
  }
  sums.mean = from;
  Plane out;
  const double length = std::hypot(dot, turn);
  if (model != MotionModel::shift && sums.spread > 0 && length > 0) {
    const double by = model == MotionModel::similarity ? sums.spread : length;
    out.ar = dot / by, out.ai = turn / by;
  }
  out.b = to - Vec2(out.ar * from.x() - out.ai * from.y(), out.ai * from.x() + out.ar * from.y());
  return out;
}

std::vector<double> distances(std::span<const RestPoint> points, const Plane& plane, const Vec2& centre) {
  std::vector<double> out;
  for (const RestPoint& p : points) out.push_back((plane.apply(p.from - centre) - (p.to - centre)).norm());
  return out;
}

double middle(std::vector<double> v) {
  if (v.empty()) return 0;
  const auto at = v.begin() + std::ptrdiff_t(v.size() / 2);
  std::nth_element(v.begin(), at, v.end());
  return *at;
}

// Splitmix64, so that the sample is the same everywhere.
std::uint64_t next(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// The model through few points that most others share.
Plane consensus(std::span<const RestPoint> points, MotionModel model, const Vec2& centre, double tolerance) {
  const std::size_t n = points.size();
  Plane best;
  double least = INFINITY;
  const auto consider = [&](std::size_t i, std::size_t j) {
    std::vector<RestPoint> two{points[i]};
    if (i != j) two.push_back(points[j]);
    Sums sums;
    const Plane plane = solved(two, std::vector<double>(two.size(), 1.0), i == j ? MotionModel::shift : model, centre, sums);
    double cost = 0;
    for (const double d : distances(points, plane, centre)) cost += std::min(d * d, tolerance * tolerance);
    if (cost < least) least = cost, best = plane;
  };
  if (model == MotionModel::shift || n == 1) {
    for (std::size_t i = 0; i < n; ++i) consider(i, i);
  } else if (n <= 32) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = i + 1; j < n; ++j) consider(i, j);
  } else {
    constexpr int samples = 500;
    std::uint64_t state = 1;
    for (int k = 0; k < samples; ++k) {
      const std::size_t i = std::size_t(next(state) % n), j = std::size_t(next(state) % n);
      if (i != j) consider(i, j);
    }
  }
  return best;
}

}  // namespace

RestFit fit_rest(std::span<const RestPoint> points, MotionModel model, const Vec2& centre, double tolerance_px,
                 double floor_px) {
  RestFit fit;
  fit.agrees.assign(points.size(), 0);
  fit.place.points = int(points.size());
  if (int(points.size()) < least_points(model)) return fit;
  Plane plane = consensus(points, model, centre, tolerance_px);
  Sums sums;
  std::vector<double> weight(points.size()), off;
  for (int iteration = 0; iteration < 20; ++iteration) {
    off = distances(points, plane, centre);
    std::vector<double> near;
    for (const double d : off)
      if (d <= tolerance_px) near.push_back(d);
    if (int(near.size()) < least_points(model)) return fit;
    const double scale = std::max(1.2 * middle(near), floor_px), reach = 4.685 * scale;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double t = off[k] <= tolerance_px ? off[k] / reach : 1;
      const double own = points[k].variance > 0 ? 1 / (points[k].variance + floor_px * floor_px) : 1;
      weight[k] = t < 1 ? own * (1 - t * t) * (1 - t * t) : 0;
    }
    plane = solved(points, weight, model, centre, sums);
    if (!(sums.weight > 0)) return fit;
  }
  off = distances(points, plane, centre);
  double squares = 0, weighted = 0, stated = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    fit.agrees[k] = off[k] <= tolerance_px;
    weighted += weight[k] * off[k] * off[k];
    stated += weight[k] * points[k].variance;
    if (!fit.agrees[k]) continue;
    squares += off[k] * off[k];
    ++fit.place.agree;
  }
  const int free = model == MotionModel::shift ? 2 : model == MotionModel::rigid ? 3 : 4;
  const double freedom = std::max(1.0, 2.0 * fit.place.agree - free);
  // Of a component of one point; the points that agree count alike.
  const double found = weighted / sums.weight * fit.place.agree / freedom, one = std::max(found, stated / sums.weight);
  fit.place.residual = std::sqrt(squares / std::max(1, fit.place.agree));
  fit.place.scale = std::hypot(plane.ar, plane.ai);
  fit.place.turn = std::atan2(plane.ai, plane.ar);
  fit.place.shift = plane.b;
  const double many = std::max(1, fit.place.agree), mean_spread = sums.spread / sums.weight;
  fit.place.var_turn = model == MotionModel::shift || !(mean_spread > 0) ? 0 : one / (many * mean_spread);
  fit.place.var_shift = one / many + fit.place.var_turn * sums.mean.squaredNorm();
  fit.found = fit.place.agree >= least_points(model);
  return fit;
}

}  // namespace pivnp::image

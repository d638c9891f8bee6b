#include "compare/data/nearest_edge.hpp"

#include <algorithm>
#include <cmath>

namespace pivnp::compare {

double nearest_parameter(const Vec2& a, const Vec2& b, const Vec2& x) {
  const Vec2 side = b - a;
  const double length2 = side.squaredNorm();
  return length2 > 0 ? std::clamp((x - a).dot(side) / length2, 0.0, 1.0) : 0.0;
}

std::int64_t NearestEdge::column(double x) const {
  constexpr double farthest = 1e9;  // fits the key; beyond it all share one column
  return std::int64_t(std::floor(std::clamp(x / cell_, -farthest, farthest)));
}

std::uint64_t NearestEdge::key(std::int64_t i, std::int64_t j) {
  return (std::uint64_t(i) << 32) ^ (std::uint64_t(j) & 0xffffffffULL);
}

void NearestEdge::build(const std::vector<std::array<int, 2>>& edges, const std::vector<Vec2>& points,
                        std::vector<double> reach) {
  reach_ = std::move(reach);
  segments_.clear();
  buckets_.clear();
  double total = 0;
  for (const auto& [a, b] : edges) {
    segments_.push_back({points[std::size_t(a)], points[std::size_t(b)]});
    total += (segments_.back()[1] - segments_.back()[0]).norm() + 2 * reach_[segments_.size() - 1];
  }
  cell_ = segments_.empty() || !(total > 0) ? 1 : total / double(segments_.size());  // few buckets a segment
  for (std::size_t e = 0; e < segments_.size(); ++e) {
    const Vec2 grow = Vec2::Constant(reach_[e]);
    const Vec2 lower = segments_[e][0].cwiseMin(segments_[e][1]) - grow;
    const Vec2 upper = segments_[e][0].cwiseMax(segments_[e][1]) + grow;
    for (std::int64_t j = column(lower.y()); j <= column(upper.y()); ++j)
      for (std::int64_t i = column(lower.x()); i <= column(upper.x()); ++i) buckets_[key(i, j)].push_back(int(e));
  }
}

NearestEdge::Hit NearestEdge::find(const Vec2& x) const {
  Hit best;
  const auto bucket = buckets_.find(key(column(x.x()), column(x.y())));
  if (bucket == buckets_.end()) return best;
  for (int e : bucket->second) {
    const auto& [a, b] = segments_[std::size_t(e)];
    const double t = nearest_parameter(a, b, x);
    const double distance = (x - (a + t * (b - a))).norm();
    if (distance < reach_[std::size_t(e)] && (best.edge < 0 || distance < best.distance)) best = {e, t, distance};
  }
  return best;
}

}  // namespace pivnp::compare

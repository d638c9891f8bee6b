#include "apps/report/content/selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "apps/plot/numbers.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/region.hpp"

namespace pivnp::report {

namespace {

// True for particles with neighbours all round at the first frame: those within two spacings of an edge are measured
// worse, and make poor examples. All true where there are too few particles, or areas are not known.
std::vector<char> surrounded(const ParticleSet& particles) {
  std::vector<char> inside(particles.size(), 1);
  if (particles.area.size() != particles.size() || particles.size() < 50) return inside;
  const double h = std::sqrt(plot::quantile({particles.area.begin(), particles.area.end()}, 0.5)), radius = 2.6 * h;
  if (!(h > 0)) return inside;
  auto cell = [&](double x) { return std::int64_t(std::floor(x / radius)); };
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> cells;
  for (std::size_t p = 0; p < particles.size(); ++p)
    cells[{cell(particles.x0[p].x()), cell(particles.x0[p].y())}].push_back(p);
  std::size_t found = 0;
  for (std::size_t p = 0; p < particles.size(); ++p) {
    const Vec2& x = particles.x0[p];
    double area = 0;
    for (std::int64_t j = -1; j <= 1; ++j)
      for (std::int64_t i = -1; i <= 1; ++i)
        if (const auto it = cells.find({cell(x.x()) + i, cell(x.y()) + j}); it != cells.end())
          for (const std::size_t q : it->second)
            if ((particles.x0[q] - x).norm() <= radius) area += double(particles.area[q]);
    inside[p] = char(area > 0.9 * std::acos(-1.0) * radius * radius);
    found += std::size_t(inside[p]);
  }
  if (found < 10) inside.assign(particles.size(), 1);
  return inside;
}

}  // namespace

std::optional<std::size_t> frame_at(const MotionSource& motion, double time) {
  const std::vector<double>& t = motion.times();
  if (t.empty()) return std::nullopt;
  std::size_t best = 0;
  for (std::size_t k = 1; k < t.size(); ++k)
    if (std::abs(t[k] - time) < std::abs(t[best] - time)) best = k;
  const double step = t.size() > 1 ? (t.back() - t.front()) / double(t.size() - 1) : std::abs(t[0]);
  if (time < t.front() - 0.51 * step - 1e-12 || time > t.back() + 0.51 * step + 1e-12) return std::nullopt;
  return best;
}

std::vector<double> chosen_times(const ReportOptions& options, const Content& content) {
  const MotionSource* motion = content.measured ? content.measured.get() : content.simulated.get();
  if (motion == nullptr || motion->times().empty()) return {};
  std::vector<double> times = options.times_s;
  if (times.empty()) {
    // Where they are compared: of the times at which both are known.
    const bool compared = content.comparison && !content.comparison->times().empty();
    const std::vector<double>& t = compared ? content.comparison->times() : motion->times();
    for (std::size_t k = 1; k <= 3; ++k) times.push_back(t[(k * (t.size() - 1) + 1) / 3]);
    if (t.size() == 2) times = {t.back()};
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

std::vector<Vec2> chosen_points(const ReportOptions& options, const Content& content) {
  std::vector<Vec2> points = positions_of(options.points_m);
  const MotionSource* motion = content.measured ? content.measured.get() : content.simulated.get();
  if (!points.empty() || motion == nullptr || motion->times().empty()) return points;

  const ParticleSet& particles = motion->particles();
  const MotionFrame last = motion->frame(motion->times().size() - 1);
  const double start = motion->times().front();
  struct Candidate {
    double displacement;
    Vec2 x0;
  };
  std::vector<Candidate> followed;
  const std::vector<char> inside = surrounded(particles);
  for (std::size_t p = 0; p < particles.size(); ++p) {
    if (!inside[p]) continue;
    const double d = std::hypot(double(last.u[p][0]), double(last.u[p][1]));
    if (alive(last.status[p]) && std::isfinite(d) && !(p < particles.born.size() && particles.born[p] > start))
      followed.push_back({d, particles.x0[p]});
  }
  std::vector<double> all;
  for (const Candidate& c : followed) all.push_back(c.displacement);
  const double threshold = 0.1 * plot::quantile(all, 0.99);
  std::vector<Candidate> moving;
  for (const Candidate& c : followed)
    if (c.displacement >= threshold) moving.push_back(c);
  if (moving.empty()) return points;
  std::stable_sort(moving.begin(), moving.end(),
                   [](const Candidate& a, const Candidate& b) { return a.displacement < b.displacement; });

  // Among those near the quartile, the one furthest from the points taken before: they should not crowd.
  const std::size_t n = moving.size(), slack = n / 25;
  for (const double q : {0.75, 0.25, 0.5}) {
    const std::size_t rank = std::size_t(std::lround(q * double(n - 1)));
    std::size_t best = rank;
    double furthest = -1;
    for (std::size_t k = rank - std::min(rank, slack); k <= std::min(n - 1, rank + slack); ++k) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Vec2& taken : points) nearest = std::min(nearest, (moving[k].x0 - taken).norm());
      if (points.empty()) nearest = k == rank ? 1 : 0;
      if (nearest > furthest) {
        furthest = nearest;
        best = k;
      }
    }
    if (furthest > 0) points.push_back(moving[best].x0);
  }
  return points;
}

}  // namespace pivnp::report

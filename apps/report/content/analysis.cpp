#include "apps/report/content/analysis.hpp"

#include "apps/plot/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

namespace pivnp::report {

namespace {
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

// True for particles with neighbours all round at the first frame: those within two spacings of an edge are measured
// worse, and make poor examples. All true where there are too few particles, or areas are not known.
std::vector<char> surrounded(const ParticleSet& particles) {
  std::vector<char> inside(particles.size(), 1);
  if (particles.area.size() != particles.size() || particles.size() < 50) return inside;
  const double h = std::sqrt(quantile({particles.area.begin(), particles.area.end()}, 0.5)), radius = 2.6 * h;
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

std::vector<PairQuality> pair_quality(const Content& content) {
  std::vector<PairQuality> all;
  for (std::size_t k = 0; k < content.pair_count; ++k) {
    const VectorField field = content.pair(k);
    PairQuality q;
    q.frames = field.pair;
    std::vector<double> score;
    double variance = 0;
    std::size_t known = 0;
    for (std::size_t n = 0; n < field.status.size(); ++n) {
      switch (field.status[n]) {
        case VectorStatus::masked: continue;
        case VectorStatus::valid: ++q.valid; break;
        case VectorStatus::replaced: ++q.replaced; break;
        case VectorStatus::rejected: ++q.rejected; break;
        case VectorStatus::failed: ++q.failed; break;
      }
      ++q.nodes;
      if (field.status[n] != VectorStatus::valid) continue;
      if (n < field.score.size()) score.push_back(double(field.score[n]));
      if (n >= field.cov.size()) continue;
      const double v = (double(field.cov[n][0]) + double(field.cov[n][1])) / 2;
      if (!std::isfinite(v)) continue;
      variance += v;
      ++known;
    }
    q.score_median = quantile(score, 0.5);
    q.score_low = quantile(score, 0.05);
    q.score_high = quantile(score, 0.95);
    q.sigma = known == 0 ? nan_value : std::sqrt(variance / double(known));
    const auto second = std::size_t(field.pair[1]);
    q.flag = field.pair[1] >= 0 && second < content.frames.size() ? content.frames[second].flag : std::uint8_t(0);
    all.push_back(q);
  }
  return all;
}

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
    const std::vector<double>& t = motion->times();
    for (std::size_t k = 1; k <= 3; ++k) times.push_back(t[(k * (t.size() - 1) + 1) / 3]);
    if (t.size() == 2) times = {t.back()};
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

std::vector<Vec2> chosen_points(const ReportOptions& options, const Content& content) {
  std::vector<Vec2> points;
  for (const Pair& p : options.points_m) points.emplace_back(p[0], p[1]);
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
    const bool alive = last.status[p] == ParticleStatus::active || last.status[p] == ParticleStatus::flagged;
    if (alive && std::isfinite(d) && !(p < particles.born.size() && particles.born[p] > start))
      followed.push_back({d, particles.x0[p]});
  }
  std::vector<double> all;
  for (const Candidate& c : followed) all.push_back(c.displacement);
  const double threshold = 0.1 * quantile(all, 0.99);
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

DifferenceHistory difference_history(const Content& content) {
  DifferenceHistory out;
  if (!content.comparison) return out;
  const ComparisonField *x = content.comparison->field("difference_x"), *y = content.comparison->field("difference_y"),
                        *magnitude = content.comparison->field("difference_magnitude");
  const bool both = x != nullptr && y != nullptr;
  if (!both && magnitude == nullptr) return out;
  const ComparisonField& any = both ? *x : *magnitude;
  const std::size_t n = any.id.size();
  if (n == 0) return out;

  std::unordered_map<std::int64_t, std::size_t> index;
  if (content.measured)
    for (std::size_t p = 0; p < content.measured->particles().size(); ++p)
      index[content.measured->particles().id[p]] = p;

  for (std::size_t k = 0; k < any.time.size(); ++k) {
    const std::optional<std::size_t> at = content.measured ? frame_at(*content.measured, any.time[k]) : std::nullopt;
    const MotionFrame frame = at ? content.measured->frame(*at) : MotionFrame{};
    double sum = 0, variance = 0;
    std::size_t known = 0;
    std::vector<double> found;
    for (std::size_t p = 0; p < n; ++p) {
      const std::size_t v = k * n + p;
      const double d =
          both ? std::hypot(double(x->values.at(v)), double(y->values.at(v))) : double(magnitude->values.at(v));
      if (!std::isfinite(d)) continue;
      sum += d * d;
      found.push_back(d);
      const auto it = index.find(any.id[p]);
      if (it == index.end() || it->second >= frame.cov_u.size()) continue;
      const auto& cov = frame.cov_u[it->second];
      const double trace = double(cov[0]) + double(cov[1]);
      if (!std::isfinite(trace)) continue;
      variance += trace;
      ++known;
    }
    out.time.push_back(any.time[k]);
    out.compared.push_back(found.size());
    out.rms.push_back(found.empty() ? nan_value : std::sqrt(sum / double(found.size())));
    out.median.push_back(quantile(found, 0.5));
    out.sigma.push_back(known == 0 ? nan_value : std::sqrt(variance / double(known)));
  }
  return out;
}

std::vector<Ends> ends_by_reason(const ParticleSet& particles) {
  std::map<EndReason, std::vector<double>> times;
  for (std::size_t p = 0; p < particles.end_reason.size(); ++p)
    if (particles.end_reason[p] != EndReason::none)
      times[particles.end_reason[p]].push_back(p < particles.end.size() ? particles.end[p] : nan_value);
  std::vector<Ends> out;
  for (const auto& [reason, t] : times)
    out.push_back({reason, t.size(), quantile(t, 0), quantile(t, 0.5), quantile(t, 1)});
  return out;
}

Box box_around(const std::vector<const std::vector<Vec2>*>& positions, double share) {
  std::array<std::vector<double>, 2> coordinate;
  for (const auto* list : positions)
    for (const Vec2& x : *list)
      if (x.allFinite())
        for (int a = 0; a < 2; ++a) coordinate[std::size_t(a)].push_back(x[a]);
  Box box{Vec2::Zero(), Vec2::Ones()};
  if (coordinate[0].empty()) return box;
  for (int a = 0; a < 2; ++a) {
    const std::vector<double>& c = coordinate[std::size_t(a)];
    box.lower[a] = quantile(c, share);
    box.upper[a] = quantile(c, 1 - share);
    // Only places far off are left out.
    const double near = 0.25 * (box.upper[a] - box.lower[a]), least = quantile(c, 0), most = quantile(c, 1);
    if (least >= box.lower[a] - near) box.lower[a] = least;
    if (most <= box.upper[a] + near) box.upper[a] = most;
  }
  double size = std::max(box.width(), box.height());
  if (size <= 0) size = std::max(1e-6, box.lower.cwiseAbs().maxCoeff() * 1e-3);
  for (int a = 0; a < 2; ++a) {  // a line of particles is given some thickness
    const double lacking = std::max(0.0, 0.05 * size - (box.upper[a] - box.lower[a]));
    box.lower[a] -= 0.03 * size + lacking / 2;
    box.upper[a] += 0.03 * size + lacking / 2;
  }
  return box;
}

}  // namespace pivnp::report

#include "compare/alignment/onset.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "compare/data/rigid.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/region.hpp"
#include "pivnp/core/record/comparison.hpp"

namespace pivnp::compare {

namespace {

struct Line {
  double zero = std::numeric_limits<double>::quiet_NaN(), sigma = zero, misfit = zero;
};

// Least squares through (t, value^(1/power)) over the rise.
Line rise(const std::vector<double>& time, const std::vector<double>& value, int power) {
  const double top = *std::max_element(value.begin(), value.end());
  if (!(top > 0)) return {};
  std::size_t end = 0;
  while (end < value.size() && !(value[end] > 0.25 * top)) ++end;
  std::size_t from = end;
  while (from > 0 && value[from - 1] > 0.02 * top) --from;
  while (end < value.size() && end - from < 3) ++end;
  if (end - from < 2) return {};
  const double n = double(end - from);
  double mt = 0, my = 0, tt = 0, ty = 0, yy = 0;
  const auto y = [&](std::size_t k) { return power == 2 ? std::sqrt(value[k] / top) : value[k] / top; };
  for (std::size_t k = from; k < end; ++k) {
    mt += time[k] / n;
    my += y(k) / n;
  }
  for (std::size_t k = from; k < end; ++k) {
    tt += (time[k] - mt) * (time[k] - mt);
    ty += (time[k] - mt) * (y(k) - my);
    yy += (y(k) - my) * (y(k) - my);
  }
  const double slope = ty / tt;
  if (!(slope > 0)) return {};
  Line line;
  line.zero = mt - my / slope;
  const double residual = std::max(0.0, yy - slope * ty), freedom = std::max(1.0, n - 2);
  const double variance = residual / freedom;
  line.sigma = std::sqrt(variance * (1 / n + (line.zero - mt) * (line.zero - mt) / tt)) / slope;
  const double step = (time[end - 1] - time[from]) / (n - 1);
  line.sigma = std::hypot(line.sigma, step / std::sqrt(12.0) / 20);
  line.misfit = residual / yy;  // 1 - R^2: comparable between the powers
  return line;
}

}  // namespace

Onset find_onset(const std::vector<double>& time, const std::vector<double>& value, int power) {
  if (time.size() < 2) return {};
  const Line line = rise(time, value, power);
  return {line.zero, line.sigma};
}

namespace {

// The displacements of one frame in the frame of the zone, if there is one.
class Seen {
 public:
  Seen(const MotionSource& motion, const Points& zone, bool turn) : motion_(motion), turn_(turn) {
    if (zone.empty()) return;
    std::vector<Vec2> vertices = positions_of(zone);
    const Polygon inside(std::move(vertices), "compare: the zone");
    for (std::size_t p = 0; p < motion.particles().size(); ++p)
      if (inside.contains(motion.particles().x0[p])) members_.push_back(p);
  }

  /// NaN where a particle is not followed.
  std::vector<Vec2> displacements(std::size_t frame) const {
    const MotionFrame f = motion_.frame(frame);
    const std::vector<Vec2>& X = motion_.particles().x0;
    std::vector<Vec2> u(X.size(), Vec2::Constant(std::nan("")));
    for (std::size_t p = 0; p < u.size(); ++p)
      if (alive(f.status[p])) u[p] = Vec2(double(f.u[p][0]), double(f.u[p][1]));
    std::vector<Vec2> from, to;
    for (const std::size_t p : members_) {
      if (!u[p].allFinite()) continue;
      from.push_back(X[p]);
      to.push_back(X[p] + u[p]);
    }
    if (from.size() < (turn_ ? 3U : 1U)) return u;
    const RigidMotion frame_motion = fit_rigid(from, to, turn_).motion;
    for (std::size_t p = 0; p < u.size(); ++p) u[p] = frame_motion.undo(X[p] + u[p]) - X[p];
    return u;
  }

 private:
  const MotionSource& motion_;
  bool turn_;
  std::vector<std::size_t> members_;
};

}  // namespace

Participation participation(const MotionSource& motion, const Points& zone, bool turn) {
  Participation out;
  const Seen seen(motion, zone, turn);
  const std::size_t frames = motion.times().size();
  const std::vector<Vec2>& X = motion.particles().x0;
  const std::vector<Vec2> end = seen.displacements(frames - 1);
  constexpr int side = 4;
  Vec2 lower = X[0], upper = X[0];
  for (const Vec2& x : X) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  const auto block = [&](const Vec2& x) {
    const Vec2 at = side * (x - lower).cwiseQuotient((upper - lower).cwiseMax(Vec2::Constant(1e-300)));
    return std::size_t(std::clamp(int(at.y()), 0, side - 1) * side + std::clamp(int(at.x()), 0, side - 1));
  };
  std::array<double, side * side> whole{};
  for (std::size_t p = 0; p < end.size(); ++p)
    if (end[p].allFinite()) whole[block(X[p])] += end[p].squaredNorm();
  const double total = std::accumulate(whole.begin(), whole.end(), 0.0);
  // A block without which nothing is left tells nothing.
  std::vector<std::size_t> left_out;
  for (std::size_t b = 0; b < whole.size(); ++b)
    if (whole[b] > 0 && whole[b] < (1 - 1e-9) * total) left_out.push_back(b);
  if (left_out.size() < 4) left_out.clear();
  out.without.resize(left_out.size());
  for (std::size_t k = 0; k < frames; ++k) {
    const std::vector<Vec2> now = seen.displacements(k);
    const MotionFrame frame = motion.frame(k);
    std::array<double, side * side> part{};
    double error = 0;
    for (std::size_t p = 0; p < end.size(); ++p) {
      if (!end[p].allFinite() || !now[p].allFinite()) continue;
      part[block(X[p])] += now[p].dot(end[p]);
      if (p >= frame.cov_u.size()) continue;
      const double variance = 0.5 * (double(frame.cov_u[p][0]) + double(frame.cov_u[p][1]));
      if (variance > 0) error += std::sqrt(variance) * end[p].norm();
    }
    const double sum = std::accumulate(part.begin(), part.end(), 0.0);
    out.time.push_back(motion.times()[k]);
    out.share.push_back(total > 0 ? sum / total : 0);
    out.sigma.push_back(total > 0 ? error / total : 0);
    for (std::size_t n = 0; n < left_out.size(); ++n)
      out.without[n].push_back((sum - part[left_out[n]]) / (total - whole[left_out[n]]));
  }
  return out;
}

namespace {

// Variance of a motion's onset that its own blocks show.
double jackknife(const Participation& motion, int power) {
  std::vector<double> zero;
  for (const std::vector<double>& share : motion.without)
    if (const double at = rise(motion.time, share, power).zero; std::isfinite(at)) zero.push_back(at);
  const double n = double(zero.size());
  if (n < 4) return 0;
  const double mean = std::accumulate(zero.begin(), zero.end(), 0.0) / n;
  double square = 0;
  for (const double z : zero) square += (z - mean) * (z - mean);
  return square * (n - 1) / n;
}

// What an error of all particles alike makes of the onset.
double shared_error(const Participation& motion, int power, double zero) {
  std::vector<double> moved = motion.share;
  for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += motion.sigma[k];
  const double at = rise(motion.time, moved, power).zero;
  return std::isfinite(at) ? at - zero : 0;
}

}  // namespace

Onset onset_offset(const Participation& first, const Participation& second) {
  if (first.time.size() < 2 || second.time.size() < 2) return {};
  const std::array<Line, 2> a{rise(first.time, first.share, 1), rise(first.time, first.share, 2)},
      b{rise(second.time, second.share, 1), rise(second.time, second.share, 2)};
  const std::size_t own = !(a[1].misfit <= a[0].misfit) ? 0 : 1;
  const int power = int(own) + 1;
  const PerDataSet<const Participation*> motions{&first, &second};
  const PerDataSet<Line> lines{a[own], b[own]};
  double variance = 0;
  for (std::size_t s = 0; s < 2; ++s) {
    const double shared = shared_error(*motions[s], power, lines[s].zero);
    variance += std::max(lines[s].sigma * lines[s].sigma, jackknife(*motions[s], power)) + shared * shared;
  }
  const double law = (a[0].zero - b[0].zero) - (a[1].zero - b[1].zero);
  if (std::isfinite(law)) variance += law * law / 12;
  return {lines[0].zero - lines[1].zero, std::sqrt(variance)};
}

}  // namespace pivnp::compare

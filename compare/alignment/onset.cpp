#include "compare/alignment/onset.hpp"

#include <algorithm>
#include <cmath>

#include "compare/data/rigid.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/region.hpp"

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
  const std::vector<Vec2> end = seen.displacements(frames - 1);
  double whole = 0;
  for (const Vec2& u : end)
    if (u.allFinite()) whole += u.squaredNorm();
  for (std::size_t k = 0; k < frames; ++k) {
    const std::vector<Vec2> now = seen.displacements(k);
    double sum = 0;
    for (std::size_t p = 0; p < end.size(); ++p)
      if (end[p].allFinite() && now[p].allFinite()) sum += now[p].dot(end[p]);
    out.time.push_back(motion.times()[k]);
    out.share.push_back(whole > 0 ? sum / whole : 0);
  }
  return out;
}

Onset onset_offset(const Participation& first, const Participation& second) {
  if (first.time.size() < 2 || second.time.size() < 2) return {};
  const Line one = rise(first.time, first.share, 1), two = rise(first.time, first.share, 2);
  const int power = !(two.misfit <= one.misfit) ? 1 : 2;
  const Line a = power == 1 ? one : two, b = rise(second.time, second.share, power);
  return {a.zero - b.zero, std::hypot(a.sigma, b.sigma)};
}

}  // namespace pivnp::compare

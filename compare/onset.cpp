#include "compare/onset.hpp"

#include <algorithm>
#include <cmath>

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
  if (end - from < 3 && end < value.size()) ++end;
  if (end - from < 3 && from > 0 && value[from - 1] > 0) --from;
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

Participation participation(const MotionSource& motion) {
  const auto alive = [](const MotionFrame& f, std::size_t p) {
    return (f.status[p] == ParticleStatus::active || f.status[p] == ParticleStatus::doubtful) &&
           std::isfinite(f.u[p][0]) && std::isfinite(f.u[p][1]);
  };
  Participation out;
  const std::size_t frames = motion.times().size(), particles = motion.particles().size();
  const MotionFrame end = motion.frame(frames - 1);
  double whole = 0;
  for (std::size_t p = 0; p < particles; ++p)
    if (alive(end, p)) whole += double(end.u[p][0]) * double(end.u[p][0]) + double(end.u[p][1]) * double(end.u[p][1]);
  for (std::size_t k = 0; k < frames; ++k) {
    const MotionFrame f = k + 1 == frames ? end : motion.frame(k);
    double sum = 0;
    for (std::size_t p = 0; p < particles; ++p)
      if (alive(end, p) && alive(f, p))
        sum += double(f.u[p][0]) * double(end.u[p][0]) + double(f.u[p][1]) * double(end.u[p][1]);
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

#include "mpm/constraint/motion_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace pivnp::mpm {

namespace {

// The row before a time within the table; never the last.
std::size_t row_before(const std::vector<double>& time, double t) {
  const auto after = std::upper_bound(time.begin(), time.end() - 1, t);
  return after == time.begin() ? 0 : std::size_t(after - time.begin()) - 1;
}

}  // namespace

void Course::prepare(const std::vector<double>& time) {
  before.assign(rows.size(), 0.0);
  for (std::size_t k = 1; k < rows.size() && rates; ++k)
    before[k] = before[k - 1] + 0.5 * (rows[k - 1] + rows[k]) * (time[k] - time[k - 1]);
}

double Course::at(const std::vector<double>& time, double t) const {
  if (!given()) return 0;
  t = std::clamp(t, time.front(), time.back());
  const std::size_t k = row_before(time, t);
  const double T = time[k + 1] - time[k], s = t - time[k];
  if (!rates) return rows[k] + s / T * (rows[k + 1] - rows[k]);
  return before[k] + s * (rows[k] + 0.5 * s / T * (rows[k + 1] - rows[k]));
}

double Course::fastest(const std::vector<double>& time) const {
  double most = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rates) most = std::max(most, std::abs(rows[k]));
    else if (k > 0) most = std::max(most, std::abs(rows[k] - rows[k - 1]) / (time[k] - time[k - 1]));
  }
  return most;
}

void MotionTable::prepare() {
  for (Course& c : courses) c.prepare(time);
}

Vec2 MotionTable::shift(double t) const {
  return {courses[0].at(time, t) - courses[0].at(time, 0), courses[1].at(time, t) - courses[1].at(time, 0)};
}

double MotionTable::turn(double t) const { return courses[2].at(time, t) - courses[2].at(time, 0); }

Vec2 ForceTable::at(double t) const {
  t = std::clamp(t, time.front(), time.back());
  const std::size_t k = row_before(time, t);
  const double s = (t - time[k]) / (time[k + 1] - time[k]);
  const auto of = [&](const std::vector<double>& r) { return r.empty() ? 0.0 : r[k] + s * (r[k + 1] - r[k]); };
  return {of(rows[0]), of(rows[1])};
}

}  // namespace pivnp::mpm

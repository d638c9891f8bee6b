#include "compare/data/data_set.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "compare/data/triangulation.hpp"
#include "pivnp/core/error.hpp"
#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::compare {

namespace {

bool usable(const MotionFrame& frame, std::size_t p) {
  return alive(frame.status[p]) && std::isfinite(frame.u[p][0]) && std::isfinite(frame.u[p][1]);
}

// Smallest step, after checking that times ascend.
double smallest_step(const MotionSource& motion) {
  const std::vector<double>& t = motion.times();
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < t.size(); ++k) step = std::min(step, t[k] - t[k - 1]);
  if (!(step > 0)) throw InputError("compare: the times of motion '" + motion.name() + "' do not ascend");
  return step;
}

std::string span(const MotionSource& motion) {
  return "'" + motion.name() + "' from " + std::to_string(motion.times().front()) + " to " +
         std::to_string(motion.times().back()) + " " + motion.time_unit();
}

template <class T>
T mixed(const T& a, const T& b, double w) {
  return w == 0 ? a : w == 1 ? b : T((1 - w) * a + w * b);
}

}  // namespace

CommonTimes common_times(const MotionSource& first, const MotionSource& second) {
  const double step = std::min(smallest_step(first), smallest_step(second));
  CommonTimes common;
  common.tolerance = std::isfinite(step) ? 1e-6 * step : 1e-12;
  common.start = std::max(first.times().front(), second.times().front());
  common.begin_together = std::abs(first.times().front() - second.times().front()) <= common.tolerance;
  const double end = second.times().back();
  for (double t : first.times())
    if (t >= common.start - common.tolerance && t <= end + common.tolerance) common.times.push_back(t);
  if (common.times.empty())
    throw InputError("compare: no time in common: first " + span(first) + ", second " + span(second));
  if (common.times.size() == 1 && (first.times().size() > 1 || second.times().size() > 1))
    throw InputError("compare: only the start is in common, where nothing has moved: first " + span(first) +
                     ", second " + span(second) + "; expected a later time that both know");
  return common;
}

DataSet::DataSet(const MotionSource& motion, const CommonTimes& common)
    : motion_(&motion), tolerance_(common.tolerance), X_(motion.particles().x0) {
  for (const Vec2& x : X_)
    if (!x.allFinite())
      throw InputError("compare: a material position of motion '" + motion.name() + "' is not a finite number");
  state_.followed.assign(X_.size(), 1);
  state_.u.assign(X_.size(), Vec2::Zero());
  state_.F.assign(X_.size(), Mat2::Identity());
  read(common.start);
  born_later_ = std::size_t(std::count(state_.followed.begin(), state_.followed.end(), 0));
  const bool earlier = motion.times().front() < common.start - common.tolerance;
  if ((earlier || !common.begin_together) && has_moved()) count_anew();
  find_spacing();
}

const MotionFrame& DataSet::frame(std::size_t index) {
  Held& held = held_[index % 2];  // neighbours never share a place
  if (!held.filled || held.index != index) {
    held.frame = motion_->frame(index);
    held.index = index;
    held.filled = true;
    if (held.frame.u.size() != X_.size() || held.frame.F.size() != X_.size() || held.frame.status.size() != X_.size())
      throw InputError("compare: frame " + std::to_string(index) + " of motion '" + motion_->name() + "' holds " +
                       std::to_string(held.frame.u.size()) + " displacements, expected " + std::to_string(X_.size()));
  }
  return held.frame;
}

void DataSet::read(double time) {
  const std::vector<double>& t = motion_->times();
  const auto after = std::upper_bound(t.begin(), t.end(), time + tolerance_);
  const std::size_t lower = std::size_t(std::max<std::ptrdiff_t>(0, after - t.begin() - 1));
  const bool between = time - t[lower] > tolerance_ && lower + 1 < t.size();
  const std::size_t upper = between ? lower + 1 : lower;
  const double w = between ? (time - t[lower]) / (t[upper] - t[lower]) : 0;
  const MotionFrame& a = frame(lower);
  const MotionFrame& b = frame(upper);

  state_.time = time;
  const bool has_cov = a.cov_u.size() == X_.size() && b.cov_u.size() == X_.size();
  state_.cov.resize(has_cov ? X_.size() : 0);
  const FieldValues *cov_F_a = a.find("cov_F"), *cov_F_b = b.find("cov_F");
  const bool has_cov_F = cov_F_a != nullptr && cov_F_b != nullptr;
  state_.cov_F.resize(has_cov_F ? X_.size() : 0);
  for (std::size_t p = 0; p < X_.size(); ++p) {
    if (!usable(a, p) || !usable(b, p)) state_.followed[p] = 0;
    if (!state_.followed[p]) continue;
    const Vec2 ua(double(a.u[p][0]), double(a.u[p][1])), ub(double(b.u[p][0]), double(b.u[p][1]));
    state_.u[p] = mixed(ua, ub, w);
    state_.F[p] = mixed(matrix(a.F[p]), matrix(b.F[p]), w);
    if (has_cov)
      for (std::size_t c = 0; c < 3; ++c)
        state_.cov[p][c] = mixed(double(a.cov_u[p][c]), double(b.cov_u[p][c]), w);
    if (has_cov_F)
      for (std::size_t c = 0; c < 3; ++c) state_.cov_F[p][c] = mixed(double((*cov_F_a)(p, c)), double((*cov_F_b)(p, c)), w);
  }
}

bool DataSet::has_moved() const {
  for (std::size_t p = 0; p < X_.size(); ++p)
    if (state_.followed[p] && (state_.u[p] != Vec2::Zero() || state_.F[p] != Mat2::Identity())) return true;
  return false;
}

void DataSet::count_anew() {
  u_start_ = state_.u;
  F_start_ = state_.F;
  for (std::size_t p = 0; p < X_.size(); ++p) {
    X_[p] += u_start_[p];
    F_start_[p] = F_start_[p].inverse().eval();
  }
}

const DataSetState& DataSet::at(double time) {
  read(time);
  if (counted_anew())
    for (std::size_t p = 0; p < X_.size(); ++p) {
      if (!state_.followed[p]) continue;
      state_.u[p] -= u_start_[p];
      state_.F[p] *= F_start_[p];
      if (state_.cov_F.empty()) continue;
      const Mat2& S = F_start_[p];
      auto& [xx, yy, xy] = state_.cov_F[p];
      Mat2 R;
      R << xx, xy, xy, yy;
      const Mat2 turned = S.transpose() * R * S;
      xx = turned(0, 0), yy = turned(1, 1), xy = turned(0, 1);
    }
  return state_;
}

// Each particle's own area where the motion knows it; else one length for all.
void DataSet::find_spacing() {
  const std::vector<double>& area = motion_->particles().area;
  const bool known = area.size() == X_.size() &&
                     std::all_of(area.begin(), area.end(), [](double a) { return std::isfinite(a) && a > 0; });
  if (known) {
    for (const double a : area) spacing_.push_back(std::sqrt(a));
    std::vector<double> sorted = spacing_;
    const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    median_spacing_ = *middle;
  } else {
    median_spacing_ = median_neighbour_distance(X_);
    if (!(median_spacing_ > 0))
      throw InputError("compare: motion '" + motion_->name() +
                       "' has no particle areas and too few particles to find their spacing");
    spacing_.assign(X_.size(), median_spacing_);
  }
}

}  // namespace pivnp::compare

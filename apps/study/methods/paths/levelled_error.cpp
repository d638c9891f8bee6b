#include "apps/study/methods/paths/levelled_error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "pivnp/core/particles/alive.hpp"
#include "pivnp/core/particles/strain.hpp"

namespace pivnp::app {

namespace {

constexpr double refuted = 3;  // stated standard deviations

void add_departure(const Vec2& off, std::array<float, 3>& cov) {
  const double x = std::sqrt(std::max(0.0, double(cov[0]))), y = std::sqrt(std::max(0.0, double(cov[1])));
  if (std::abs(off.x()) <= refuted * x && std::abs(off.y()) <= refuted * y) return;
  cov[0] += float(off.x() * off.x()), cov[1] += float(off.y() * off.y()), cov[2] += float(off.x() * off.y());
}

// Errors (I + E) F whose components of E have the variance s^2 give each row of F the covariance s^2 F^T F, and the
// deviatoric strain some 2/3 s^2.
void add_strain(const Mat2& F, double off, FieldValues& cov, std::size_t p) {
  if (!(F.determinant() > 0) || !std::isfinite(off)) return;
  const Mat2 back = F.inverse();
  Mat2 R;
  R << double(cov(p, 0)), double(cov(p, 2)), double(cov(p, 2)), double(cov(p, 1));
  const double stated = 2.0 / 3 * 0.5 * (back.transpose() * R * back).trace();
  if (off * off <= refuted * refuted * stated) return;
  const Mat2 more = 1.5 * off * off * F.transpose() * F;
  cov(p, 0) += float(more(0, 0)), cov(p, 1) += float(more(1, 1)), cov(p, 2) += float(more(0, 1));
}

}  // namespace

LevelledMotion::LevelledMotion(std::unique_ptr<MotionSource> levelled, const Comparison& against)
    : levelled_(std::move(levelled)), column_(levelled_->particles().size(), -1) {
  const ComparisonField *x = against.field("difference_x"), *y = against.field("difference_y"),
                        *dev = against.field("difference_strain_dev");
  if (x == nullptr || y == nullptr || dev == nullptr) return;
  time_ = x->time, columns_ = x->id.size();
  x_ = x->values, y_ = y->values, dev_ = dev->values;
  std::unordered_map<std::int64_t, std::ptrdiff_t> at;
  for (std::size_t k = 0; k < x->id.size(); ++k) at[x->id[k]] = std::ptrdiff_t(k);
  for (std::size_t p = 0; p < column_.size(); ++p)
    if (const auto found = at.find(levelled_->particles().id[p]); found != at.end()) column_[p] = found->second;
}

MotionFrame LevelledMotion::frame(std::size_t index) const {
  MotionFrame f = levelled_->frame(index);
  const auto row = std::find(time_.begin(), time_.end(), f.time);
  if (row == time_.end()) return f;
  const std::size_t first = std::size_t(row - time_.begin()) * columns_;
  FieldValues* cov_F = nullptr;
  for (FieldValues& field : f.fields)
    if (&field == f.find("cov_F")) cov_F = &field;
  for (std::size_t p = 0; p < column_.size(); ++p) {
    if (column_[p] < 0 || !alive(f.status[p])) continue;
    const std::size_t k = first + std::size_t(column_[p]);
    const Vec2 off{double(x_[k]), double(y_[k])};
    if (!off.allFinite()) continue;
    if (!f.cov_u.empty()) add_departure(off, f.cov_u[p]);
    if (cov_F != nullptr) add_strain(matrix(f.F[p]), double(dev_[k]), *cov_F, p);
  }
  return f;
}

}  // namespace pivnp::app

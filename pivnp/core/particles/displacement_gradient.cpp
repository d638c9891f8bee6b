#include "pivnp/core/particles/displacement_gradient.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace pivnp {

namespace {

// Points in square cells, about two a cell.
class Cells {
 public:
  explicit Cells(const std::vector<Vec2>& X) : X_(X) {
    lower_ = upper_ = X.empty() ? Vec2(Vec2::Zero()) : X[0];
    for (const Vec2& x : X) {
      lower_ = lower_.cwiseMin(x);
      upper_ = upper_.cwiseMax(x);
    }
    const Vec2 size = upper_ - lower_;
    const double longest = std::max(size.x(), size.y());
    cell_ = std::max(
        std::sqrt(std::max(size.prod(), 1e-6 * longest * longest) * 2 / double(std::max<std::size_t>(1, X.size()))),
        longest * 1e-4);
    if (!(cell_ > 0)) cell_ = 1;
    nx_ = int(size.x() / cell_) + 1;
    ny_ = int(size.y() / cell_) + 1;
    start_.assign(std::size_t(nx_) * std::size_t(ny_) + 1, 0);
    for (const Vec2& x : X) ++start_[index(x) + 1];
    for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    member_.resize(X.size());
    for (std::size_t p = 0; p < X.size(); ++p) member_[next[index(X[p])]++] = std::int32_t(p);
  }

  /// The nearest to point p, without itself, nearest first; ties by index.
  void nearest(std::size_t p, std::size_t wanted, std::vector<std::pair<double, std::int32_t>>& found) const {
    found.clear();
    const int ci = column(X_[p].x()), cj = row(X_[p].y()), furthest = std::max(nx_, ny_);
    for (int ring = 0; ring <= furthest; ++ring) {
      for (int j = std::max(0, cj - ring); j <= std::min(ny_ - 1, cj + ring); ++j)
        for (int i = std::max(0, ci - ring); i <= std::min(nx_ - 1, ci + ring); ++i) {
          if (std::max(std::abs(i - ci), std::abs(j - cj)) != ring) continue;
          const std::size_t c = std::size_t(j) * std::size_t(nx_) + std::size_t(i);
          for (std::size_t k = start_[c]; k < start_[c + 1]; ++k)
            if (member_[k] != std::int32_t(p))
              found.emplace_back((X_[std::size_t(member_[k])] - X_[p]).squaredNorm(), member_[k]);
        }
      if (found.size() < wanted) continue;
      std::sort(found.begin(), found.end());
      // Everything nearer than `ring` whole cells has been seen.
      if (found[wanted - 1].first <= double(ring) * double(ring) * cell_ * cell_) break;
    }
    std::sort(found.begin(), found.end());
    if (found.size() > wanted) found.resize(wanted);
  }

 private:
  int column(double x) const { return std::clamp(int((x - lower_.x()) / cell_), 0, nx_ - 1); }
  int row(double y) const { return std::clamp(int((y - lower_.y()) / cell_), 0, ny_ - 1); }
  std::size_t index(const Vec2& x) const {
    return std::size_t(row(x.y())) * std::size_t(nx_) + std::size_t(column(x.x()));
  }

  const std::vector<Vec2>& X_;
  Vec2 lower_, upper_;
  double cell_ = 1;
  int nx_ = 1, ny_ = 1;
  std::vector<std::size_t> start_;
  std::vector<std::int32_t> member_;
};

}  // namespace

DisplacementGradient::DisplacementGradient(const std::vector<Vec2>& X) : X_(X), nearest_(X.size()) {
  const Cells cells(X_);
  std::vector<std::pair<double, std::int32_t>> found;
  for (std::size_t p = 0; p < X_.size(); ++p) {
    cells.nearest(p, neighbours, found);
    nearest_[p].fill(-1);
    for (std::size_t k = 0; k < found.size(); ++k) nearest_[p][k] = found[k].second;
  }
}

std::vector<std::array<float, 4>> DisplacementGradient::gradients(const std::vector<std::array<float, 2>>& u,
                                                                  const std::vector<std::int32_t>& since) const {
  assert(u.size() == X_.size() && since.size() == X_.size());
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<std::array<float, 4>> F(X_.size(), {nan, nan, nan, nan});
  for (std::size_t p = 0; p < X_.size(); ++p) {
    if (since[p] == 0) continue;
    double furthest = 0;
    int count = 0;
    for (const std::int32_t q : nearest_[p]) {
      if (q < 0 || since[std::size_t(q)] != since[p]) continue;
      furthest = std::max(furthest, (X_[std::size_t(q)] - X_[p]).squaredNorm());
      ++count;
    }
    if (count < 3 || !(furthest > 0)) continue;
    Mat2 A = Mat2::Zero(), B = Mat2::Zero();  // sum w r r^T, sum w d r^T
    for (const std::int32_t q : nearest_[p]) {
      if (q < 0 || since[std::size_t(q)] != since[p]) continue;
      const Vec2 r = X_[std::size_t(q)] - X_[p];
      const Vec2 d(double(u[std::size_t(q)][0]) - double(u[p][0]), double(u[std::size_t(q)][1]) - double(u[p][1]));
      const double w = std::exp(-2 * r.squaredNorm() / furthest);
      A += w * r * r.transpose();
      B += w * d * r.transpose();
    }
    const double trace = A.trace();
    if (!(A.determinant() > 1e-4 * trace * trace)) continue;  // on a line
    const Mat2 f = Mat2::Identity() + B * A.inverse();
    F[p] = {float(f(0, 0)), float(f(0, 1)), float(f(1, 0)), float(f(1, 1))};
  }
  return F;
}

}  // namespace pivnp

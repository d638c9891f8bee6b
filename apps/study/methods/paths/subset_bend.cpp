#include "apps/study/methods/paths/subset_bend.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace pivnp::app {

namespace {

// Places sorted into squares of a subset's half side: those within a subset lie in 3 x 3 of them.
class Bins {
 public:
  Bins(const std::vector<Vec2>& places, double side) : side_(side) {
    Vec2 upper = places.front();
    lower_ = upper;
    for (const Vec2& x : places) lower_ = lower_.cwiseMin(x), upper = upper.cwiseMax(x);
    nx_ = int((upper.x() - lower_.x()) / side) + 1, ny_ = int((upper.y() - lower_.y()) / side) + 1;
    start_.assign(std::size_t(nx_) * std::size_t(ny_) + 1, 0);
    std::vector<std::size_t> bin(places.size());
    for (std::size_t k = 0; k < places.size(); ++k) ++start_[(bin[k] = bin_of(places[k])) + 1];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    order_.resize(places.size());
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    for (std::size_t k = 0; k < places.size(); ++k) order_[next[bin[k]]++] = k;
  }

  template <class Visit>
  void around(const Vec2& x, const Visit& visit) const {
    const int i = int((x.x() - lower_.x()) / side_), j = int((x.y() - lower_.y()) / side_);
    for (int b = std::max(j - 1, 0); b <= std::min(j + 1, ny_ - 1); ++b)
      for (int a = std::max(i - 1, 0); a <= std::min(i + 1, nx_ - 1); ++a) {
        const std::size_t at = std::size_t(b) * std::size_t(nx_) + std::size_t(a);
        for (std::size_t n = start_[at]; n < start_[at + 1]; ++n) visit(order_[n]);
      }
  }

 private:
  std::size_t bin_of(const Vec2& x) const {
    return std::size_t((x.y() - lower_.y()) / side_) * std::size_t(nx_) + std::size_t((x.x() - lower_.x()) / side_);
  }
  double side_;
  Vec2 lower_;
  int nx_ = 1, ny_ = 1;
  std::vector<std::size_t> start_, order_;
};

}  // namespace

std::vector<SubsetBend> subset_bends(const std::vector<Vec2>& from, const std::vector<Vec2>& to,
                                     const std::vector<Mat2>& A, double half_side, int threads) {
  std::vector<SubsetBend> bends(from.size());
  if (from.empty()) return bends;
  const Bins bins(from, half_side);
  constexpr int least = 12;
#pragma omp parallel for schedule(static) num_threads(threads)
  for (std::ptrdiff_t p = 0; p < std::ptrdiff_t(from.size()); ++p) {
    const auto k = std::size_t(p);
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 2> right = Eigen::Matrix<double, 6, 2>::Zero();
    Vec2 square = Vec2::Zero();
    int count = 0;
    bins.around(from[k], [&](std::size_t q) {
      const Vec2 r = (from[q] - from[k]) / half_side;
      if (!(r.cwiseAbs().maxCoeff() <= 1)) return;
      const Vec2 moved = (to[q] - to[k]) - A[k] * (from[q] - from[k]);  // what bends, and little else
      Eigen::Matrix<double, 6, 1> terms;
      terms << 1, r.x(), r.y(), r.x() * r.x(), r.x() * r.y(), r.y() * r.y();
      normal += terms * terms.transpose();
      right += terms * moved.transpose();
      square += moved.cwiseAbs2();
      ++count;
    });
    if (count < least) continue;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> bent(normal);
    const Eigen::LDLT<Eigen::Matrix3d> flat(normal.topLeftCorner<3, 3>());
    const Eigen::VectorXd pivots = bent.vectorD();
    if (!(pivots.minCoeff() > 1e-6 * pivots.maxCoeff())) continue;  // all on a line or two
    const Eigen::Matrix<double, 6, 2> quadratic = bent.solve(right);
    const Eigen::Matrix<double, 3, 2> affine = flat.solve(right.topRows<3>());
    bends[k].place = (affine.row(0) - quadratic.row(0)).transpose();
    bends[k].centre = quadratic.row(0).transpose();
    bends[k].gradient = affine.bottomRows<2>().norm() / (2 * half_side);
    // Sums of x and y over their count, in halves of the side: a half subset has 1/2.
    bends[k].whole = normal.row(0).segment<2>(1).norm() < 0.2 * count;
    bends[k].bend = quadratic.bottomRows<3>().transpose() / (half_side * half_side);
    const Vec2 explained = (quadratic.array() * right.array()).colwise().sum().matrix().transpose();
    bends[k].left = ((square - explained).cwiseMax(Vec2::Zero()) / count).cwiseSqrt();
  }
  return bends;
}

}  // namespace pivnp::app

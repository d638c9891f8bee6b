#include "pivnp/piv/window/subset.hpp"

#include <omp.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "pivnp/core/error.hpp"
#include "pivnp/piv/window/subset_kernels.hpp"

namespace pivnp::piv {

namespace {

int team(int threads) { return threads > 0 ? threads : omp_get_max_threads(); }

}  // namespace

void SubsetImage::assign(const ImageView& image, const MaskView& masked, int threads) {
  width = image.width, height = image.height;
  grey.assign(image, masked, 1, team(threads));
  mask.clear();
  if (masked.data == nullptr) return;
  mask.resize(std::size_t(width) * std::size_t(height));
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) mask[std::size_t(r) * std::size_t(width) + std::size_t(c)] = masked.usable(c, r);
}

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr double edge = 1;  // room for gradients and for the iterations

bool usable_at(const SubsetImage& image, double x, double y) {
  if (!(x >= edge && y >= edge && x <= image.width - 1 - edge && y <= image.height - 1 - edge)) return false;
  if (image.mask.empty()) return true;
  const int c = int(x), r = int(y);
  const auto at = [&](int column, int row) {
    return image.mask[std::size_t(row) * std::size_t(image.width) + std::size_t(column)] != 0;
  };
  return at(c, r) && at(c + 1, r) && at(c, r + 1) && at(c + 1, r + 1);
}

// Whether all pixels may be used that lie at most (rx, ry) from a place.
bool usable_around(const SubsetImage& image, const Vec2& x, double rx, double ry) {
  if (!(x.x() - rx >= edge && x.y() - ry >= edge && x.x() + rx <= image.width - 1 - edge &&
        x.y() + ry <= image.height - 1 - edge))
    return false;
  if (image.mask.empty()) return true;
  const int left = int(x.x() - rx), columns = int(x.x() + rx) + 2 - left;
  for (int r = int(x.y() - ry); r <= int(x.y() + ry) + 1; ++r)
    if (std::memchr(image.mask.data() + std::size_t(r) * std::size_t(image.width) + std::size_t(left), 0,
                    std::size_t(columns)) != nullptr)
      return false;
  return true;
}

// Work space of one thread, and the subset it holds: planes of grey values and slopes (subset_kernels.hpp).
class Subset {
 public:
  explicit Subset(const SubsetOptions& options)
      : options_(options), side_(options.side_px), half_(side_ / 2), stride_(subset_stride(side_)) {
    const std::size_t plane = std::size_t(side_) * std::size_t(stride_);
    for (auto* v : {&use_, &f_, &g_, &fx_, &fy_, &slope_}) v->resize(plane);
    beside_.resize(plane + 2 * std::size_t(stride_));  // a row and a column more
    line_.resize(2 * std::size_t(stride_));
    sums_.resize(ResidualScratch(side_).floats());
  }

  SubsetMatch match(const SubsetImage& first, const SubsetImage& second, const AffinePrediction& guess) {
    SubsetMatch m;
    m.to = guess.to;
    m.A = guess.A;
    bend_ = guess.bend;
    if (!guess.from.allFinite() || !guess.to.allFinite() || !guess.A.allFinite()) return m;
    if (!take(first, second, guess) || !refine_reference()) return m;
    const double far = half_;
    for (int n = 0; n < options_.max_iterations; ++n) {
      if (!compare(second, m)) return m;
      Vec6 right;
      residual_slopes(f_.data(), g_.data(), float(gain_), fx_.data(), fy_.data(), side_, right.data());
      const Vec6 p = -(inverse_ * right);
      Mat2 step;
      step << 1 + p[1], p[2], p[4], 1 + p[5];
      if (!(step.determinant() > 0.1)) return m;
      m.A = m.A * step.inverse();
      m.to -= m.A * Vec2(p[0], p[3]);
      if (!m.to.allFinite() || (m.to - guess.to).norm() > options_.farthest_px) return m;
      if (Vec2(p[0], p[3]).norm() + far * Eigen::Vector4d(p[1], p[2], p[4], p[5]).norm() < options_.tolerance_px) {
        m.found = compare(second, m);
        if (m.found) state_errors(second, m);
        return m;
      }
    }
    return m;
  }

 private:
  // The usable pixels and their grey values and slopes in the first image.
  bool take(const SubsetImage& first, const SubsetImage& second, const AffinePrediction& guess) {
    SubsetWarp here;
    here.x = guess.from.x(), here.y = guess.from.y();
    if (!count_usable(first, second, guess)) return false;
    warp_subset(first.grey, here, -half_, -half_, side_, side_, stride_, line_.data(), f_.data());
    between(first.grey, here, true, fx_);
    between(first.grey, here, false, fy_);
    return true;
  }

  bool count_usable(const SubsetImage& first, const SubsetImage& second, const AffinePrediction& guess) {
    std::fill(use_.begin(), use_.end(), 0.0f);
    const Vec2 reach =
        half_ * guess.A.cwiseAbs().rowwise().sum() + half_ * half_ * guess.bend.cwiseAbs().rowwise().sum();
    const bool whole =
        usable_around(first, guess.from, half_, half_) && usable_around(second, guess.to, reach.x(), reach.y());
    std::size_t count = 0;
    for (int b = -half_; b <= half_; ++b) {
      float* row = use_.data() + (b + half_) * stride_ + half_;
      for (int a = -half_; a <= half_; ++a) {
        const Vec2 r(a, b);
        if (!whole) {
          const Vec2 from = guess.from + r, to = guess.to + guess.A * r + bend_ * Eigen::Vector3d(a * a, a * b, b * b);
          if (!usable_at(first, from.x(), from.y()) || !usable_at(second, to.x(), to.y())) continue;
        }
        row[a] = 1;
        ++count;
      }
    }
    count_ = double(count);
    return count_ >= options_.min_usable * double(side_) * double(side_);
  }

  // Central difference over one pixel of the subset along one of its axes.
  void between(const SplineImage& image, const SubsetWarp& warp, bool along_x, std::vector<float>& out) {
    warp_subset(image, warp, along_x ? -half_ - 0.5 : -half_, along_x ? -half_ : -half_ - 0.5,
                side_ + (along_x ? 1 : 0), side_ + (along_x ? 0 : 1), stride_, line_.data(), beside_.data());
    slopes_of(beside_.data() + (along_x ? 1 : stride_), beside_.data(), use_.data(), side_, out.data());
  }

  bool refine_reference() {
    energy_f_ = centre_subset(f_.data(), use_.data(), side_, count_);
    double sums[3][6];
    slope_products(fx_.data(), fy_.data(), side_, sums);
    // Unknowns: shift and gradient of the template in x, then in y; the factors 1, a, b of two of them.
    constexpr int factors[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) hessian_(i, j) = sums[i / 3 + j / 3][factors[i % 3][j % 3]];
    const Eigen::LDLT<Mat6> solver(hessian_);
    // No texture: grey values that vary no more than rounding makes them, or along one direction only.
    if (!(energy_f_ > count_ * 4.0 / 12) || solver.info() != Eigen::Success || !solver.isPositive() ||
        !(hessian_(0, 0) > 0) || !(hessian_(3, 3) > 0))
      return false;
    inverse_ = solver.solve(Mat6::Identity());
    return inverse_.allFinite();
  }

  SubsetWarp warp_of(const SubsetMatch& m) const {
    SubsetWarp warp;
    warp.x = m.to.x(), warp.y = m.to.y();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) warp.A[i][j] = m.A(i, j);
      for (int j = 0; j < 3; ++j) warp.bend[i][j] = bend_(i, j);
    }
    return warp;
  }

  // The second image under the present warp, freed of its mean; the gain that fits it to the first.
  bool compare(const SubsetImage& second, const SubsetMatch& m) {
    warp_subset(second.grey, warp_of(m), -half_, -half_, side_, side_, stride_, line_.data(), g_.data());
    const double energy = centre_subset(g_.data(), use_.data(), side_, count_);
    if (!(energy > 0)) return false;
    gain_ = std::sqrt(energy_f_ / energy);
    return true;
  }

  // Score and covariances of a match, from the residuals it leaves.
  void state_errors(const SubsetImage& second, SubsetMatch& m) {
    const ResidualSums left =
        residual_sums(f_.data(), g_.data(), float(gain_), fx_.data(), fy_.data(), side_, sums_.data());
    m.score = left.product / energy_f_;
    const double variance = left.squares / std::max(1.0, count_ - 6);
    const double excess = slopes_not_shared(second, m);
    const Mat6 cov = variance * together(left) * excess * excess * inverse_;
    // `to` moves by A times what the template moves.
    const Mat2 to = m.A * (Mat2() << cov(0, 0), cov(0, 3), cov(3, 0), cov(3, 3)).finished() * m.A.transpose();
    m.cov = {to(0, 0), to(1, 1), to(0, 1)};
    m.var_A = (cov(1, 1) + cov(2, 2) + cov(4, 4) + cov(5, 5)) / 4;
  }

  // Slopes that are noise, or texture that the second image lacks, are in the Hessian but do not move the minimum: the
  // Hessian over the slopes' products between both images.
  double slopes_not_shared(const SubsetImage& second, const SubsetMatch& m) {
    double own = 0, shared = 0;
    for (const bool along_x : {true, false}) {
      const float* slope = along_x ? fx_.data() : fy_.data();
      between(second.grey, warp_of(m), along_x, slope_);
      own += product_sum(slope, slope, side_);
      shared += gain_ * product_sum(slope, slope_.data(), side_);
    }
    return shared > 0.2 * own ? std::max(1.0, own / shared) : 5.0;
  }

  // How much more the sum of slope x residual varies than if its terms were independent: their products over lags below
  // 4 px, with weights that fall linearly (Bartlett), over the squares alone. Those weights are a box's correlation
  // with itself: the products are the squares of sums over boxes.
  static double together(const ResidualSums& left) {
    constexpr double box = residual_span * residual_span;
    return left.alone > 0 ? std::max(1.0, left.together / (box * left.alone)) : 1.0;
  }

  SubsetOptions options_;
  int side_, half_;
  std::ptrdiff_t stride_;
  double count_ = 0;                                  // of the pixels used
  std::vector<float> use_, f_, g_, fx_, fy_, slope_;  // planes
  std::vector<float> beside_, line_, sums_;           // scratch
  double energy_f_ = 0, gain_ = 1;
  Eigen::Matrix<double, 2, 3> bend_ = Eigen::Matrix<double, 2, 3>::Zero();
  Mat6 hessian_, inverse_;
};

}  // namespace

std::vector<SubsetMatch> match_subsets(const SubsetImage& first, const SubsetImage& second,
                                       std::span<const AffinePrediction> predictions, const SubsetOptions& options,
                                       int threads) {
  if (first.width != second.width || first.height != second.height)
    throw InputError("direct correlation: found images of " + std::to_string(first.width) + " x " +
                     std::to_string(first.height) + " and " + std::to_string(second.width) + " x " +
                     std::to_string(second.height) + " px, expected one size");
  if (options.side_px < 7 || options.side_px % 2 == 0)
    throw InputError("direct correlation: found a subset of " + std::to_string(options.side_px) +
                     " px, expected an odd number, at least 7");
  std::vector<SubsetMatch> matches(predictions.size());
#pragma omp parallel num_threads(team(threads))
  {
    Subset subset(options);
#pragma omp for schedule(dynamic, 16)
    for (std::ptrdiff_t k = 0; k < std::ptrdiff_t(predictions.size()); ++k)
      matches[std::size_t(k)] = subset.match(first, second, predictions[std::size_t(k)]);
  }
  return matches;
}

}  // namespace pivnp::piv

#include "pivnp/piv/window/subset.hpp"

#include <omp.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pivnp/core/error.hpp"

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

bool usable_at(const SubsetImage& image, double x, double y) {
  constexpr double edge = 1;  // room for gradients and for the iterations
  if (!(x >= edge && y >= edge && x <= image.width - 1 - edge && y <= image.height - 1 - edge)) return false;
  if (image.mask.empty()) return true;
  const int c = int(x), r = int(y);
  const auto at = [&](int column, int row) {
    return image.mask[std::size_t(row) * std::size_t(image.width) + std::size_t(column)] != 0;
  };
  return at(c, r) && at(c + 1, r) && at(c, r + 1) && at(c + 1, r + 1);
}

// Work space of one thread, and the subset it holds.
class Subset {
 public:
  explicit Subset(const SubsetOptions& options) : options_(options), half_(options.side_px / 2) {
    const std::size_t all = std::size_t(options.side_px) * std::size_t(options.side_px);
    for (auto* v : {&rx_, &ry_, &x_, &y_, &f_, &g_, &fx_, &fy_, &low_}) v->resize(all);
    slot_.resize(all);
    residual_.resize(all);
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
      Vec6 right = Vec6::Zero();
      for (std::size_t k = 0; k < count_; ++k) {
        const double e = double(f_[k]) - gain_ * double(g_[k]);
        const double gx = double(fx_[k]), gy = double(fy_[k]), x = double(rx_[k]), y = double(ry_[k]);
        right += e * (Vec6() << gx, gy, gx * x, gx * y, gy * x, gy * y).finished();
      }
      const Vec6 p = -(inverse_ * right);
      Mat2 step = Mat2::Identity();
      step(0, 0) += p[2], step(0, 1) += p[3], step(1, 0) += p[4], step(1, 1) += p[5];
      if (!(step.determinant() > 0.1)) return m;
      m.A = m.A * step.inverse();
      m.to -= m.A * Vec2(p[0], p[1]);
      if (!m.to.allFinite() || (m.to - guess.to).norm() > options_.farthest_px) return m;
      if (Vec2(p[0], p[1]).norm() + far * Eigen::Vector4d(p[2], p[3], p[4], p[5]).norm() < options_.tolerance_px) {
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
    count_ = 0;
    for (int b = -half_; b <= half_; ++b)
      for (int a = -half_; a <= half_; ++a) {
        const Vec2 r(a, b), from = guess.from + r, to = guess.to + guess.A * r + bent(a, b);
        const std::size_t place = std::size_t((b + half_) * options_.side_px + a + half_);
        const bool here = usable_at(first, from.x(), from.y()) && usable_at(second, to.x(), to.y());
        slot_[place] = here ? int(count_) : -1;
        if (!here) continue;
        rx_[count_] = float(a), ry_[count_] = float(b);
        x_[count_] = float(from.x()), y_[count_] = float(from.y());
        ++count_;
      }
    if (double(count_) < options_.min_usable * double(options_.side_px) * double(options_.side_px)) return false;
    const int n = int(count_);
    first.grey.sample(x_.data(), y_.data(), n, f_.data());
    slope(first, x_, fx_);
    slope(first, y_, fy_);
    return true;
  }

  // Central difference over one pixel along the axis whose coordinates are given.
  void slope(const SubsetImage& first, std::vector<float>& along, std::vector<float>& out) {
    for (std::size_t k = 0; k < count_; ++k) along[k] -= 0.5f;
    first.grey.sample(x_.data(), y_.data(), int(count_), low_.data());
    for (std::size_t k = 0; k < count_; ++k) along[k] += 1.0f;
    first.grey.sample(x_.data(), y_.data(), int(count_), out.data());
    for (std::size_t k = 0; k < count_; ++k) along[k] -= 0.5f, out[k] -= low_[k];
  }

  Vec2 bent(double a, double b) const { return bend_ * Eigen::Vector3d(a * a, a * b, b * b); }

  static double centre(std::vector<float>& v, std::size_t count) {
    double mean = 0, energy = 0;
    for (std::size_t k = 0; k < count; ++k) mean += double(v[k]);
    mean /= double(count);
    for (std::size_t k = 0; k < count; ++k) {
      v[k] = float(double(v[k]) - mean);
      energy += double(v[k]) * double(v[k]);
    }
    return energy;
  }

  bool refine_reference() {
    energy_f_ = centre(f_, count_);
    hessian_.setZero();
    for (std::size_t k = 0; k < count_; ++k) {
      const double gx = double(fx_[k]), gy = double(fy_[k]), x = double(rx_[k]), y = double(ry_[k]);
      const Vec6 j = (Vec6() << gx, gy, gx * x, gx * y, gy * x, gy * y).finished();
      hessian_.selfadjointView<Eigen::Lower>().rankUpdate(j);
    }
    hessian_ = Mat6(hessian_.selfadjointView<Eigen::Lower>());
    const Eigen::LDLT<Mat6> solver(hessian_);
    // No texture: grey values that vary no more than rounding makes them, or along one direction only.
    if (!(energy_f_ > double(count_) * 4.0 / 12) || solver.info() != Eigen::Success || !solver.isPositive() ||
        !(hessian_(0, 0) > 0) || !(hessian_(1, 1) > 0))
      return false;
    inverse_ = solver.solve(Mat6::Identity());
    return inverse_.allFinite();
  }

  // The second image under the present warp, freed of its mean; the gain that fits it to the first.
  bool compare(const SubsetImage& second, const SubsetMatch& m) {
    const float right = float(second.width - 1), bottom = float(second.height - 1);
    for (std::size_t k = 0; k < count_; ++k) {
      const double a = double(rx_[k]), b = double(ry_[k]);
      const Vec2 c = bent(a, b);
      x_[k] = std::clamp(float(m.to.x() + m.A(0, 0) * a + m.A(0, 1) * b + c.x()), 0.0f, right);
      y_[k] = std::clamp(float(m.to.y() + m.A(1, 0) * a + m.A(1, 1) * b + c.y()), 0.0f, bottom);
    }
    second.grey.sample(x_.data(), y_.data(), int(count_), g_.data());
    const double energy = centre(g_, count_);
    if (!(energy > 0)) return false;
    gain_ = std::sqrt(energy_f_ / energy);
    return true;
  }

  // Score and covariances of a match, from the residuals it leaves.
  void state_errors(const SubsetImage& second, SubsetMatch& m) {
    double product = 0, left = 0;
    std::fill(residual_.begin(), residual_.end(), std::array<double, 2>{0, 0});
    for (std::size_t place = 0; place < slot_.size(); ++place) {
      if (slot_[place] < 0) continue;
      const auto k = std::size_t(slot_[place]);
      const double e = double(f_[k]) - gain_ * double(g_[k]);
      product += double(f_[k]) * gain_ * double(g_[k]);
      left += e * e;
      residual_[place] = {double(fx_[k]) * e, double(fy_[k]) * e};
    }
    m.score = product / energy_f_;
    const double variance = left / std::max(1.0, double(count_) - 6);
    const double excess = slopes_not_shared(second, m);
    const Mat6 cov = variance * together() * excess * excess * inverse_;
    // `to` moves by A times what the template moves.
    const Mat2 to = m.A * cov.topLeftCorner<2, 2>() * m.A.transpose();
    m.cov = {to(0, 0), to(1, 1), to(0, 1)};
    m.var_A = cov.diagonal().tail<4>().mean();
  }

  // Slopes that are noise, or texture that the second image lacks, are in the Hessian but do not move the minimum: the
  // Hessian over the slopes' products between both images.
  double slopes_not_shared(const SubsetImage& second, const SubsetMatch& m) {
    double own = 0, shared = 0;
    for (const bool along_x : {true, false}) {
      const Vec2 half = 0.5 * m.A.col(along_x ? 0 : 1);
      const auto sample = [&](double sign, std::vector<float>& out) {
        for (std::size_t k = 0; k < count_; ++k) {
          const double a = double(rx_[k]), b = double(ry_[k]);
          const Vec2 at = m.to + m.A * Vec2(a, b) + bent(a, b) + sign * half;
          x_[k] = std::clamp(float(at.x()), 0.0f, float(second.width - 1));
          y_[k] = std::clamp(float(at.y()), 0.0f, float(second.height - 1));
        }
        second.grey.sample(x_.data(), y_.data(), int(count_), out.data());
      };
      sample(-1, low_);
      sample(1, g_);
      const std::vector<float>& slope = along_x ? fx_ : fy_;
      for (std::size_t k = 0; k < count_; ++k) {
        own += double(slope[k]) * double(slope[k]);
        shared += double(slope[k]) * gain_ * double(g_[k] - low_[k]);
      }
    }
    return shared > 0.2 * own ? std::max(1.0, own / shared) : 5.0;
  }

  // How much more the sum of slope x residual varies than if its terms were independent: their products over lags below
  // 4 px, with weights that fall linearly (Bartlett), over the squares alone.
  double together() const {
    constexpr int span = 4;
    const int side = options_.side_px;
    double alone = 0, summed = 0;
    for (const std::size_t q : {std::size_t(0), std::size_t(1)})
      for (int dy = -span + 1; dy < span; ++dy)
        for (int dx = -span + 1; dx < span; ++dx) {
          const double weight = (1 - std::abs(dx) / double(span)) * (1 - std::abs(dy) / double(span));
          double sum = 0;
          for (int r = std::max(0, -dy); r < std::min(side, side - dy); ++r)
            for (int c = std::max(0, -dx); c < std::min(side, side - dx); ++c)
              sum += residual_[std::size_t(r * side + c)][q] * residual_[std::size_t((r + dy) * side + c + dx)][q];
          summed += weight * sum;
          if (dx == 0 && dy == 0) alone += sum;
        }
    return alone > 0 ? std::max(1.0, summed / alone) : 1.0;
  }

  SubsetOptions options_;
  int half_;
  std::size_t count_ = 0;
  std::vector<float> rx_, ry_, x_, y_, f_, g_, fx_, fy_, low_;
  std::vector<int> slot_;                          // of a place in the square; -1: not used
  std::vector<std::array<double, 2>> residual_;    // slope times residual, at its place in the square
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

#include "compare/uncertainty/field_mean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "compare/data/rigid.hpp"
#include "compare/data/statistics.hpp"

namespace pivnp::compare {

namespace {

// Sixteen blocks tell a standard deviation to about a fifth: Student's factor for 15 degrees of freedom over the normal
// one, at 95 %.
constexpr double of_few_blocks = 2.131 / 1.960;

}  // namespace

FieldMean::FieldMean(std::size_t particles) : sum_(particles), sigma_(particles), count_(particles) { clear(); }

void FieldMean::clear() {
  std::fill(sum_.begin(), sum_.end(), Vec2(Vec2::Zero()));
  std::fill(sigma_.begin(), sigma_.end(), Vec2(Vec2::Zero()));
  std::fill(count_.begin(), count_.end(), 0U);
  common_ = Vec2::Zero();
  n_ = 0;
}

void FieldMean::add(std::size_t row, const Vec2& difference, const Vec2& random, const Vec2& common) {
  sum_[row] += difference;
  sigma_[row] += random.cwiseSqrt();
  ++count_[row];
  common_ += common.cwiseSqrt();
  ++n_;
}

std::optional<FieldMean::Weighted> FieldMean::weighted(const std::vector<Vec2>& X, const std::vector<Vec2>& difference,
                                                       const std::vector<Vec2>& random, const std::vector<Vec2>& common,
                                                       double correlation_length) {
  const std::size_t n = X.size();
  std::vector<double> variance(n);
  for (std::size_t p = 0; p < n; ++p) variance[p] = (random[p] + common[p]).sum();
  if (n == 0 || !std::all_of(variance.begin(), variance.end(), [](double v) { return std::isfinite(v); }))
    return std::nullopt;
  std::vector<double> ordered = variance;
  std::nth_element(ordered.begin(), ordered.begin() + std::ptrdiff_t(n / 2), ordered.end());
  const double median = ordered[n / 2];
  if (!(median > 0)) return std::nullopt;
  Weighted out;
  double total = 0, square = 0, known = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const double w = median / std::max(variance[p], median);
    total += w;
    out.mean += w * difference[p];
    square += w * difference[p].squaredNorm();
    known += w * variance[p];
  }
  out.mean /= total;
  out.rms = std::sqrt(square / total);
  out.rms_uncertainty = std::sqrt(known / total);
  out.uncertainty = Vec2::Constant(not_known);
  if (!(correlation_length > 0)) return out;
  // As uncertainty(), of weighted sums; the jackknife leaves out one block after the other.
  constexpr int side = 4;
  Vec2 lower = X[0], upper = X[0];
  for (const Vec2& x : X) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  std::array<Vec2, side * side> sum;
  std::array<double, side * side> weight{};
  sum.fill(Vec2::Zero());
  std::map<std::pair<long, long>, Vec2> cells;
  Vec2 alike = Vec2::Zero();
  for (std::size_t p = 0; p < n; ++p) {
    const double w = median / std::max(variance[p], median);
    const Vec2 at = X[p] / correlation_length,
               block = side * (X[p] - lower).cwiseQuotient((upper - lower).cwiseMax(Vec2::Constant(1e-300)));
    const auto b =
        std::size_t(std::clamp(int(block.y()), 0, side - 1) * side + std::clamp(int(block.x()), 0, side - 1));
    sum[b] += w * difference[p];
    weight[b] += w;
    cells.try_emplace({long(std::floor(at.x())), long(std::floor(at.y()))}, Vec2::Zero()).first->second +=
        w * random[p].cwiseSqrt();
    alike += w * common[p].cwiseSqrt();
  }
  Vec2 stated = Vec2::Zero(), shown = Vec2::Zero();
  for (const auto& [cell, sigma] : cells) stated += (sigma / total).cwiseAbs2();
  double blocks = 0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (!(weight[b] > 0) || !(weight[b] < total)) continue;
    const Vec2 without = (out.mean * total - sum[b]) / (total - weight[b]);
    shown += (without - out.mean).cwiseAbs2();
    ++blocks;
  }
  if (blocks < 4) return out;
  shown *= (blocks - 1) / blocks * of_few_blocks * of_few_blocks;
  out.uncertainty = (stated.cwiseMax(shown) + (alike / total).cwiseAbs2()).cwiseSqrt();
  return out;
}

Vec2 FieldMean::uncertainty(const std::vector<Vec2>& X, double correlation_length) const {
  if (n_ == 0 || !(correlation_length > 0)) return Vec2::Constant(not_known);
  std::map<std::pair<long, long>, Vec2> cells;
  std::vector<Vec2> place, moved;
  for (std::size_t row = 0; row < X.size(); ++row) {
    if (count_[row] == 0) continue;
    const Vec2 at = X[row] / correlation_length;
    cells.try_emplace({long(std::floor(at.x())), long(std::floor(at.y()))}, Vec2::Zero()).first->second += sigma_[row];
    place.push_back(X[row]);
    moved.push_back(X[row] + sum_[row] / double(count_[row]));
  }
  const double n = double(n_);
  Vec2 stated = Vec2::Zero();
  for (const auto& [cell, sigma] : cells) stated += (sigma / n).cwiseAbs2();
  // Without rows and columns of blocks, errors are taken as the same everywhere.
  const Vec2 shown = fit_rigid(place, moved, false).sigma_shift * of_few_blocks;
  if (!shown.allFinite() || !stated.allFinite()) return Vec2::Constant(not_known);
  return (stated.cwiseMax(shown.cwiseAbs2()) + (common_ / n).cwiseAbs2()).cwiseSqrt();
}

}  // namespace pivnp::compare

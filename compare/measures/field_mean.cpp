#include "compare/measures/field_mean.hpp"

#include <algorithm>
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

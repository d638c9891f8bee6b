#include "compare/data/statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace pivnp::compare {

namespace {

// A non-negative float's bits rise with its value: exponent and the first 12 bits of the mantissa number a bin.
constexpr int dropped_bits = 11;
constexpr std::size_t bin_count = std::size_t(1) << (31 - dropped_bits);

std::size_t bin_of(double value) { return std::bit_cast<std::uint32_t>(float(value)) >> dropped_bits; }

double middle_of(std::size_t bin) {
  const std::uint32_t low = std::uint32_t(bin) << dropped_bits;
  return low == 0 ? 0 : double(std::bit_cast<float>(low | (1U << (dropped_bits - 1))));
}

double root_mean(double sum, std::size_t count) { return count > 0 ? std::sqrt(sum / double(count)) : not_known; }

}  // namespace

void Quantile::count(double value) { ++bins_[bin_of(value)]; }

void Quantile::add(double value) {
  ++size_;
  if (!bins_.empty()) return count(value);
  values_.push_back(value);
  if (values_.size() <= exact_limit) return;
  bins_.assign(bin_count, 0);
  for (double v : values_) count(v);
  values_ = {};
}

double Quantile::at(double q) const {
  if (size_ == 0) return not_known;
  const std::size_t rank = std::max<std::size_t>(1, std::size_t(std::ceil(q * double(size_) - 1e-9)));
  if (bins_.empty()) {
    std::vector<double> sorted = values_;
    const auto place = sorted.begin() + std::ptrdiff_t(rank - 1);
    std::nth_element(sorted.begin(), place, sorted.end());
    return *place;
  }
  std::size_t seen = 0, bin = 0;
  while (bin + 1 < bin_count && (seen += bins_[bin]) < rank) ++bin;
  return middle_of(bin);
}

void VectorStatistics::add(const Vec2& difference, double cov_uu, double cov_vv) {
  ++count_;
  sum_ += difference;
  sum_cov_ += Vec2(cov_uu, cov_vv);
  sum_square_ += difference.squaredNorm();
  const double magnitude = difference.norm();
  magnitude_.add(magnitude);
  const double sigma = std::sqrt(cov_uu + cov_vv);
  if (sigma > 0 && std::isfinite(sigma)) over_uncertainty_.add(magnitude / sigma);
  if (std::isfinite(sigma))
    sigma_.add(sigma);
  else
    ++unknown_;
  if (magnitude > max_ || count_ == 1) {
    max_ = magnitude;
    max_sigma_ = sigma;
  }
}

double VectorStatistics::rms() const { return root_mean(sum_square_, count_); }
Vec2 VectorStatistics::bias_uncertainty() const {
  return {root_mean(sum_cov_.x(), count_), root_mean(sum_cov_.y(), count_)};
}
double VectorStatistics::p95_uncertainty() const { return unknown_ == 0 ? sigma_.at(0.95) : not_known; }
double VectorStatistics::rms_uncertainty() const { return root_mean(sum_cov_.sum(), count_); }

void ScalarStatistics::add(double difference, double variance) {
  ++count_;
  sum_ += difference;
  sum_square_ += difference * difference;
  sum_variance_ += variance;
  const double size = std::abs(difference), sigma = std::sqrt(variance);
  if (size > max_ || count_ == 1) max_ = size, max_sigma_ = sigma;
  magnitude_.add(size);
  if (sigma > 0) sigma_.add(sigma);
}

double ScalarStatistics::rms_uncertainty() const { return root_mean(sum_variance_, count_); }
double ScalarStatistics::p95_uncertainty() const {
  if (std::isnan(sum_variance_)) return not_known;
  return sum_variance_ > 0 ? sigma_.at(0.95) : 0;
}

double ScalarStatistics::rms() const { return root_mean(sum_square_, count_); }

OverTime::OverTime(std::size_t particles, std::size_t most)
    : kept_(most / 20 + 1), count_(particles, 0), sum_(particles, Vec2::Zero()), square_(particles, 0.0),
      top_(particles * kept_) {}

void OverTime::add(std::size_t particle, const Vec2& value) {
  const auto first = top_.begin() + std::ptrdiff_t(particle * kept_);
  const std::size_t held = std::min<std::size_t>(count_[particle]++, kept_);
  sum_[particle] += value;
  square_[particle] += value.squaredNorm();
  const float size = float(value.norm());
  if (held < kept_) {
    first[std::ptrdiff_t(held)] = size;
    std::push_heap(first, first + std::ptrdiff_t(held) + 1, std::greater<>());
  } else if (size > *first) {
    std::pop_heap(first, first + std::ptrdiff_t(kept_), std::greater<>());
    first[std::ptrdiff_t(kept_) - 1] = size;
    std::push_heap(first, first + std::ptrdiff_t(kept_), std::greater<>());
  }
}

Vec2 OverTime::bias(std::size_t particle) const {
  return count_[particle] > 0 ? Vec2(sum_[particle] / double(count_[particle])) : Vec2::Constant(not_known);
}
double OverTime::rms(std::size_t particle) const { return root_mean(square_[particle], count_[particle]); }

double OverTime::p95(std::size_t particle) const {
  const std::size_t n = count_[particle];
  if (n == 0) return not_known;
  const std::size_t rank = std::max<std::size_t>(1, std::size_t(std::ceil(0.95 * double(n) - 1e-9)));
  const auto first = top_.begin() + std::ptrdiff_t(particle * kept_);
  std::vector<float> held(first, first + std::ptrdiff_t(std::min(n, kept_)));
  std::sort(held.begin(), held.end(), std::greater<>());
  return double(held[n - rank]);
}

double OverTime::max(std::size_t particle) const {
  const std::size_t n = count_[particle];
  if (n == 0) return not_known;
  const auto first = top_.begin() + std::ptrdiff_t(particle * kept_);
  return double(*std::max_element(first, first + std::ptrdiff_t(std::min(n, kept_))));
}

void StillZone::add(double dev, double vol, double path) {
  if (!std::isfinite(dev) || !std::isfinite(vol) || !std::isfinite(path)) return;
  ++count_;
  dev_square_ += dev * dev;
  vol_square_ += vol * vol;
  path_square_ += path * path;
}

double StillZone::root_mean(double square_sum) const {
  return count_ >= least ? std::sqrt(square_sum / double(count_)) : not_known;
}

}  // namespace pivnp::compare

// Sums taken while the frames stream by; memory does not grow with their number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::compare {

inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Quantiles of non-negative values: exact (nearest rank) up to `exact_limit` values; beyond it by counts in bins of a
/// relative width of 2^-12, answered by the bin's middle.
class Quantile {
 public:
  static constexpr std::size_t exact_limit = std::size_t(1) << 20;

  void add(double value);
  /// Smallest value that at least the share q in (0, 1] of all values do not exceed; NaN without values.
  double at(double q) const;

 private:
  void count(double value);

  std::vector<double> values_;
  std::vector<std::uint64_t> bins_;  // empty while exact
  std::size_t size_ = 0;
};

/// Differences of one scalar.
class ScalarStatistics {
 public:
  /// `variance`: of the difference, NaN if not known.
  void add(double difference, double variance = 0);

  std::size_t count() const { return count_; }
  double bias() const { return sum_ / double(count_); }
  double rms() const;
  double p95() const { return magnitude_.at(0.95); }
  double max() const { return max_; }
  // Standard uncertainties, errors of all taken as one and the same; NaN where one is not known.
  double rms_uncertainty() const;
  double p95_uncertainty() const;                        // 95th percentile of their own
  double max_uncertainty() const { return max_sigma_; }  // where the greatest difference is

 private:
  std::size_t count_ = 0;
  double sum_ = 0, sum_square_ = 0, sum_variance_ = 0, max_ = 0, max_sigma_ = not_known;
  Quantile magnitude_, sigma_;
};

/// Differences of displacement, or of velocity, of many particle-times, every one counted alike.
class VectorStatistics {
 public:
  /// `cov`: uu, vv of the difference (NaN if not known).
  void add(const Vec2& difference, double cov_uu, double cov_vv);

  std::size_t count() const { return count_; }
  std::size_t count_unknown() const { return unknown_; }  // without an uncertainty
  Vec2 bias() const { return sum_ / double(count_); }
  double rms() const;
  double p95() const { return magnitude_.at(0.95); }
  double max() const { return max_; }
  // Standard uncertainties, errors of all particles taken as one and the same.
  Vec2 bias_uncertainty() const;
  double rms_uncertainty() const;
  double p95_uncertainty() const;  // 95th percentile of the particles' own, NaN if one is not known
  double max_uncertainty() const { return max_sigma_; }  // of the particle where the greatest difference is
  /// Sizes in units of the particle's own uncertainty, over those that have one above zero.
  const ScalarStatistics& over_uncertainty() const { return over_uncertainty_; }

 private:
  std::size_t count_ = 0;
  Vec2 sum_ = Vec2::Zero(), sum_cov_ = Vec2::Zero();
  double sum_square_ = 0, max_ = 0, max_sigma_ = not_known;
  Quantile magnitude_, sigma_;
  ScalarStatistics over_uncertainty_;
  std::size_t unknown_ = 0;
};

/// Over the times of each of many particles: mean of a vector, RMS, 95th percentile (nearest rank) and maximum of its
/// size. The percentile is exact: of `most` values a particle the greatest twentieth is kept, and no more.
class OverTime {
 public:
  OverTime(std::size_t particles, std::size_t most);

  void add(std::size_t particle, const Vec2& value);
  std::size_t count(std::size_t particle) const { return count_[particle]; }
  // NaN for a particle without values.
  Vec2 bias(std::size_t particle) const;
  double rms(std::size_t particle) const;
  double p95(std::size_t particle) const;
  double max(std::size_t particle) const;

 private:
  std::size_t kept_;
  std::vector<std::uint32_t> count_;
  std::vector<Vec2> sum_;
  std::vector<double> square_;
  std::vector<float> top_;  // kept_ a particle: a heap with its least value first
};

/// What strain a data set shows in a zone that is declared to stand still. All of it is taken as error, so real strain
/// there makes the floor too high, never too low.
class StillZone {
 public:
  static constexpr std::size_t least = 20;  // particles that make a zone

  /// Deviatoric, volumetric, along the path. A particle without strain is left out.
  void add(double dev, double vol, double path);
  /// Root mean squares; NaN with fewer than `least` particles.
  double dev() const { return root_mean(dev_square_); }
  double vol() const { return root_mean(vol_square_); }
  double path() const { return root_mean(path_square_); }

 private:
  double root_mean(double square_sum) const;

  std::size_t count_ = 0;
  double dev_square_ = 0, vol_square_ = 0, path_square_ = 0;
};

}  // namespace pivnp::compare

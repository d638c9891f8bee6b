// The mean difference over the material, with an uncertainty that knows how far errors are shared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "compare/uncertainty/budget.hpp"
#include "pivnp/core/math.hpp"

namespace pivnp::compare {

/// Random errors are one and the same within a cell as large as their correlation length, and independent from cell to
/// cell; from time to time they are one and the same. Camera, gauge, frame of reference, clock, numerics and inputs err
/// alike everywhere. So the variance of a mean of n values is
///   u^2 = max(sum over cells (sum of sigma)^2 / n^2, jackknife over 4 x 4 blocks of the material) + (mean u_common)^2.
/// The jackknife is of the differences themselves: errors that are larger, or reach further, than is stated widen it.
class FieldMean {
 public:
  explicit FieldMean(std::size_t particles);

  /// One particle at one time. `random`: variances of both data sets' random errors together, NaN if not known;
  /// `common`: of the rest of u_val.
  void add(std::size_t row, const Vec2& difference, const Vec2& random, const Vec2& common);
  void clear();

  /// The same with weights 1 / max(u_p, median u)^2, u_p each particle's own u_val: what is known badly counts little,
  /// and nothing counts much because it is thought to be known well. Values of one time each.
  struct Weighted {
    Vec2 mean = Vec2::Zero(), uncertainty = Vec2::Zero();  // of the difference
    double rms = 0, rms_uncertainty = 0;                   // of its size, and of u_val
  };
  /// Nothing where uncertainties are not known; the mean's is NaN without a correlation length.
  static std::optional<Weighted> weighted(const std::vector<Vec2>& X, const std::vector<Vec2>& difference,
                                          const std::vector<Vec2>& random, const std::vector<Vec2>& common,
                                          double correlation_length);

  /// Standard uncertainty of the mean's x and y. `X`: material positions by row. NaN without a value, or where a random
  /// error is not known.
  Vec2 uncertainty(const std::vector<Vec2>& X, double correlation_length) const;

 private:
  std::vector<Vec2> sum_, sigma_;  // of the differences and of the random errors' standard deviations, over the times
  std::vector<std::uint32_t> count_;
  Vec2 common_ = Vec2::Zero();
  std::size_t n_ = 0;
};

}  // namespace pivnp::compare

// What every correlation method does, and what they share. A method is one file and one row of the list in methods.cpp;
// PairCorrelator makes it anew for every other mask.
#pragma once

#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/sampling/anchor_shares.hpp"
#include "pivnp/piv/validation/vector_validation.hpp"

namespace pivnp::piv {

class Method {
 public:
  virtual ~Method() = default;
  /// Fills displacement, status, cov, score and correlation_px. As it gets them nothing is measured: values NaN, status
  /// masked where a node is off, failed elsewhere.
  virtual void correlate(const ImageView& first, const ImageView& second, PixelVectors& vectors) = 0;
};

inline ValidationLimits limits_of(const PivOptions& options) {
  return {options.median_threshold, options.median_floor_px, options.min_score,
          options.max_sigma_px,     options.min_usable,      options.replace};
}

/// Variance of a grey value's rounding, grey^2.
inline float rounding_variance(const ImageView& image) {
  return image.depth == PixelDepth::f32 ? 1e-14f * image.white * image.white : 1.0f / 12.0f;
}

}  // namespace pivnp::piv

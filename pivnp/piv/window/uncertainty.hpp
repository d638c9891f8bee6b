// First error estimate of a vector, from its matched windows.
#pragma once

#include <array>
#include <vector>

#include "pivnp/piv/window/correlate.hpp"
#include "pivnp/piv/window/window.hpp"

namespace pivnp::piv {

/// The estimate below is the error of one pass. Repeated passes widen the band of wavelengths that is followed, and
/// with it the noise: this is the factor on the variance, measured on uniformly moved frames with 5 and 10 % noise.
float iteration_variance(int passes);

/// Correlation statistics (Wieneke 2015): the peak's offset follows the difference of its flanks,
///   c(+1) - c(-1) = sum over pixels of D(x),  D(x) = a(x) b(x + 1) - a(x + 1) b(x)  (over |a| |b|),
/// which vanishes pixel by pixel where the windows agree. What noise, lost particles and unresolved gradients leave in
/// D is a sum of terms correlated over a few pixels; its variance is estimated by summing products of D over
/// separations below `flank_span` pixels with weights falling linearly (Bartlett), and carried to the offset by the
/// derivative of the three-point fit. At least the variance that rounding of grey values causes (`rounding_variance`,
/// grey^2 a frame) is reported. Not contained: systematic error (peak locking, truncation of unresolved gradients).
class UncertaintyEstimator {
 public:
  explicit UncertaintyEstimator(int side);
  /// Covariance (xx, yy, xy), pixels of the window squared; infinite where the peak is flat.
  std::array<float, 3> covariance(const Window& window, const Peak& peak, float rounding_variance);

 private:
  std::vector<float> scratch_;
};

}  // namespace pivnp::piv

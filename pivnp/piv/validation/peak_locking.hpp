// Are displacements drawn towards whole pixels? Two signs: blobs too small for the pixels, and errors that follow the
// fraction of the displacement (Westerweel 1997, Meas. Sci. Technol. 8; Overmars et al. 2010).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/record/vector_status.hpp"

namespace pivnp::piv {

/// Diameter (four standard deviations) of the texture's blobs, px, at least about 0.9: from the autocorrelation's fall
/// from one pixel of lag to two, which noise between pixels does not affect; the pixel's own width is subtracted. Means
/// of blocks of 32 px are subtracted first: illumination and large shapes do not count. NaN without texture.
double blob_diameter(const ImageView& image, const MaskView& mask);

/// Blobs smaller than this are warned of: uniform shifts of blobs of 2 / 1.5 / 1 px are measured to .009 / .017 / .039
/// px by 32 px windows, of 3 px to .005 (noise-free, worst fraction).
inline constexpr double least_blob_px = 1.7;

/// Fits error = -a sin(2 pi d) to fields of vectors: what a vector deviates by from a cubic through its neighbours (5 x
/// 5) against what that error would make it deviate by. An even field has nothing to tell, whatever its fraction.
class FractionStatistics {
 public:
  static constexpr int bins = 20;

  /// One pair's valid vectors, px; nx as of their lattice.
  void add(int nx, const std::vector<std::array<float, 2>>& displacement, const std::vector<VectorStatus>& status);

  /// Share of components by their fraction, -0.5 to 0.5 px about the next whole pixel.
  std::array<double, bins> histogram() const;
  /// a, px: positive toward whole pixels; and its standard error. NaN where the displacements vary too little to tell
  /// (standard error above .02 px).
  double amplitude() const;
  double amplitude_error() const;
  /// Drawn toward whole pixels beyond doubt, and by more than .02 px.
  bool locked() const;

 private:
  std::array<std::int64_t, bins> counts_{};
  double cross_ = 0, square_ = 0, residual_ = 0;
  std::int64_t fits_ = 0;
};

}  // namespace pivnp::piv

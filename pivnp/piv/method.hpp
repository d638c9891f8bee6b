// What every correlation method does. A method is one file; PairCorrelator picks it by name.
#pragma once

#include "pivnp/piv/piv.hpp"

namespace pivnp::piv {

class Method {
 public:
  virtual ~Method() = default;
  /// Fills displacement, status, cov and score of every node (arrays already of the lattice's size).
  virtual void correlate(const ImageView& first, const ImageView& second, const MaskView& mask,
                         PixelVectors& vectors) = 0;
};

}  // namespace pivnp::piv

// Eulerian cross-correlation: displacement of the image at fixed nodes, from one pair of frames.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/options.hpp"
#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/validation/pixel_vectors.hpp"

namespace pivnp::piv {

struct DenseField;

struct FramePair {
  ImageView first, second;
  MaskView material = {};  // of correlate_mean(): what of the first frame is material, beside the mask; no data: all
};

/// Correlates pairs of frames of one size on one lattice. Keeps plans and buffers; `correlate` uses `threads` threads
/// and gives the same bits for any number of them.
///
/// Anchors: central, the material that is at the node x midway was at x - d/2 in the first frame and is at x + d/2 in
/// the second; forward, what is at x in the first frame is at x + d in the second.
/// Status: masked, the node is off or masks leave too little of its window (NaN); failed, outside the image, too near
/// its edge, or no texture above rounding (NaN); rejected, measured but untrusted: score or stated error beyond its
/// limit, no peak, or out of line with its neighbours (value kept); replaced, rebuilt from neighbours, score as
/// measured. Covariance: random error only (docs: correlation statistics); systematic error comes on top.
/// Throws InputError: unknown method, an anchor, window or mask that the method cannot take, windows that do not fit,
/// arrays or frames of another size.
class PairCorrelator {
 public:
  PairCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height, int threads);
  ~PairCorrelator();
  /// Puts the nodes elsewhere ([ny][nx], column and row), for the pairs to come: where a moving camera sees them. What the method is made for
  /// follows by itself where they go far; `anew`: now, if they are elsewhere (so that what follows does not depend on what went before).
  void place(const std::vector<std::array<float, 2>>& pixel, bool anew = false);
  /// `material`: what of the first frame is material, beside the mask; empty: all. It may differ from pair to pair, and
  /// nothing is made anew for it: where material goes to in the second frame, the vectors say.
  /// `before`: vectors that this pair's may be near; it is then searched from their valid ones on, by windows no larger than the last.
  PixelVectors correlate(const ImageView& first, const ImageView& second, const MaskView& mask, const MaskView& material = {},
                         const PixelVectors* before = nullptr);
  /// The mean displacement of several pairs: their correlations are averaged, window by window, before a peak is sought
  /// (Delnoij et al. 1999, Chem. Eng. Sci. 54:5159; Meinhart, Wereley & Santiago 2000, J. Fluids Eng. 122:285). The
  /// covariance takes the pairs' errors for independent. Vectors that start on what is not material in the middle pair
  /// are masked. Throws as correlate(), and InputError where the method has no correlation to average.
  PixelVectors correlate_mean(std::span<const FramePair> pairs, const MaskView& mask);
  /// The field that the last pair's vectors are from, and the place in the frames of its (0, 0); null where the method
  /// has none.
  const DenseField* field() const;
  std::array<int, 2> field_origin() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::piv

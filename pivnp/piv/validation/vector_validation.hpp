// From the field of a dense method to vectors at the nodes: value, covariance, score and status.
#pragma once

#include "pivnp/core/image_view.hpp"
#include "pivnp/piv/dense/quality.hpp"
#include "pivnp/piv/sampling/lattice.hpp"
#include "pivnp/piv/validation/pixel_vectors.hpp"

namespace pivnp::piv {

/// What a vector must meet to be valid; the words of [piv].
struct ValidationLimits {
  double median_threshold = 2, median_floor_px = 0.1;
  double min_score = 0.1, max_sigma_px = 0.7, min_usable = 0.4;
  bool replace = true;  // rebuild rejected vectors from their neighbours
};

struct ValidationInput {
  ValidationLimits limits;
  const NodeLattice& nodes;
  int width, height;  // of the full image
  int decimation;     // of the level that the field lives on
  int threads;
  float rounding;  // variance of a grey value's rounding, grey^2
  MaskView mask;   // of the full image
};

/// `field` the result, `sums` the last pass' with scores, `u`, `v` the field at the lattice's points, `smooth_*` what
/// smoothing left of their errors. Nodes already masked stay so. `trusted`: of the
/// lattice's points.
void validate_vectors(const ValidationInput& input, const SplineField& field, const CellSums& sums,
                      const std::vector<float>& u, const std::vector<float>& v, const SmoothedField& smooth_u,
                      const SmoothedField& smooth_v, PixelVectors& vectors, std::vector<std::uint8_t>& trusted);

}  // namespace pivnp::piv

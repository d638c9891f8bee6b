// From the field of a dense method to vectors at the nodes: value, covariance, score and status.
#pragma once

#include "pivnp/piv/piv.hpp"
#include "pivnp/piv/quality.hpp"

namespace pivnp::piv {

struct JudgeInput {
  const PivOptions& options;
  const NodeLattice& nodes;
  int width, height;  // of the full image
  int decimation;     // of the level that the field lives on
  int threads;
  float rounding;  // variance of a grey value's rounding, grey^2
};

/// `field` the result, `sums` the last pass' with scores, `u`, `v` the field at the lattice's points, `smooth_*` what
/// smoothing left of their errors. Nodes already masked stay so.
void judge_nodes(const JudgeInput& input, const SplineField& field, const CellSums& sums, const std::vector<float>& u,
                 const std::vector<float>& v, const SmoothedField& smooth_u, const SmoothedField& smooth_v,
                 PixelVectors& vectors);

}  // namespace pivnp::piv

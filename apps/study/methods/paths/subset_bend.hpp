// What an affine subset cannot follow: how the path field bends over it.
#pragma once

#include <vector>

#include "pivnp/core/math.hpp"

namespace pivnp::app {

/// Of one subset. A field u that is bent over it is matched by its affine least squares fit.
struct SubsetBend {
  Vec2 place = Vec2::Zero();  // at its centre the affine fit is off by this much (px): fit less field
  double gradient = 0;        // RMS of a component by which the fit's gradient differs from that at the centre
  Eigen::Matrix<double, 2, 3> bend = Eigen::Matrix<double, 2, 3>::Zero();  // of the quadratic fit: x^2, x y, y^2, 1/px
  bool whole = false;         // particles lie on all sides of the centre: the fit holds over all of the subset
  Vec2 centre = Vec2::Zero();  // at the centre the quadratic fit is off by this much (px): fit less field
  Vec2 left = Vec2::Zero();   // what the quadratic fit leaves, RMS over the subset (px): higher orders, and noise
};

/// For subsets of `half_side` px around each of the places `from`, whose material is predicted at `to` with the gradient
/// `A`: affine and quadratic least squares fits of all predictions within the subset, which average the errors of single
/// predictions. Where fewer than 12 lie within it: none is known, zeros.
std::vector<SubsetBend> subset_bends(const std::vector<Vec2>& from, const std::vector<Vec2>& to,
                                     const std::vector<Mat2>& A, double half_side, int threads);

}  // namespace pivnp::app

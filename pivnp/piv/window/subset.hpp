// Direct correlation of two frames that may lie far apart: a subset at any place of the first, found in the second from
// a predicted position and deformation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pivnp/core/image_view.hpp"
#include "pivnp/core/math.hpp"
#include "pivnp/piv/sampling/spline_image.hpp"

namespace pivnp::piv {

struct SubsetOptions {
  int side_px = 31;           // of the square subset, odd
  double min_usable = 0.7;    // share of its pixels that masks and the images' edges must leave
  int max_iterations = 30;
  double tolerance_px = 1e-3; // of the last change of position (and, at the subset's edge, of deformation)
  double farthest_px = 4;     // a result farther from the prediction is none
};

/// A frame made ready: spline coefficients and mask. Keeps its buffers when another frame is put in.
struct SubsetImage {
  SplineImage grey;
  std::vector<std::uint8_t> mask;  // [height][width], 0: not to be used; empty: all may
  int width = 0, height = 0;

  SubsetImage() = default;
  SubsetImage(const ImageView& image, const MaskView& masked, int threads) { assign(image, masked, threads); }
  void assign(const ImageView& image, const MaskView& masked, int threads);
};

/// Pixel frame (column, row): what is at `from` + r in the first image is predicted at `to` + A r + bend (x^2, x y, y^2) in the
/// second, r = (x, y). The bend is taken as it is given: position and A are what is sought.
struct AffinePrediction {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  Mat2 A = Mat2::Identity();
  Eigen::Matrix<double, 2, 3> bend = Eigen::Matrix<double, 2, 3>::Zero();  // 1/px
};

struct SubsetMatch {
  bool found = false;   // converged, near the prediction, on enough pixels; nothing is said of the score
  Vec2 to = Vec2::Zero();
  Mat2 A = Mat2::Identity();
  double score = 0;     // zero-normalised correlation coefficient of the matched subsets, -1 .. 1
  std::array<double, 3> cov{0, 0, 0};  // of `to`: uu, vv, uv, px^2; random error only
  double var_A = 0;                    // variance of a component of A (mean of the four)
};

/// Matches every prediction: inverse compositional Gauss-Newton on a warp that is affine but for the given bend (Baker &
/// Matthews 2004), criterion
/// zero-normalised sum of squared differences (Pan, Li & Tong 2013), quintic spline interpolation in both images, so
/// that `from` need not lie on a pixel. Converges from about a texture grain's size; the prediction must be that good.
/// Covariance: residual variance times the inverse Hessian, times the factor for the correlation of the residuals of
/// neighbouring pixels (their products summed to 4 px), times the square of the factor by which slopes that both images
/// do not have in common (noise, lost texture) steepen the Hessian without holding the minimum. Same bits for any
/// number of threads. `threads` = 0: all cores. Throws InputError for images of different size or a side below 7 px.
std::vector<SubsetMatch> match_subsets(const SubsetImage& first, const SubsetImage& second,
                                       std::span<const AffinePrediction> predictions, const SubsetOptions& options,
                                       int threads);

}  // namespace pivnp::piv

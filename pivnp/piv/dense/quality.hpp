// How well the frames match where a pass has brought them together, and what that makes of a vector.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/normal_sums.hpp"
#include "pivnp/piv/dense/shrink.hpp"

namespace pivnp::piv {

/// At the points of a lattice, from the sums of a pass with scores.
struct MatchQuality {
  std::vector<float> score;       // correlation coefficient about the point (window of about 26 px at 8 px spacing)
  std::vector<float> wide_score;  // and of the same sums over 7 x 7 points
  std::vector<float> usable;      // share of usable pixels about the point, 0 ... 1
  std::vector<float> variance;  // of the first frame's grey values about the point, grey^2, the smaller of both frames'
  std::vector<float> contrast;  // that variance over its mean over the lattice
  std::vector<float> slant;     // correlation between the errors of u and v that the texture causes, -1 ... 1
};

void match_quality(const CellSums& sums, MatchQuality& quality);

/// Points where light seems to move over the material: where the pass has matched the frames, the mean grey value about the point still
/// changes, by more than 2.4 % and six times what half of the points exceed, with texture all round. Empty where these are
/// fewer than eight, or a thousandth of all.
std::vector<std::size_t> moving_light(const CellSums& sums, float rounding);

/// Square of the error that a vector would have by the texture about the point alone, whatever smoothing makes of its
/// surroundings: least squares over the window of `score` (`window`) or the point's own cell, in the worse direction;
/// level pixels squared, infinite where the frames have no gradients in common but shading's. Noise is the matched
/// frames' own residual about the point. `rounding`: variance of a grey value's rounding, grey^2.
void own_variance(const CellSums& sums, bool window, float rounding, std::vector<float>& variance);

/// Mean square, over 5 x 5 points, of what windows would still move by (least squares over the window of `score`; 1.5 at
/// most), by the pixels that they see; level pixels squared. Where the passes have converged it is noise of own_variance's size.
void open_correction(const CellSums& sums, std::vector<float>& square);

/// Whether a field has settled on what its windows show: their open correction and own variance, pixels of the level.
bool settled(float square, float own, int decimation);

/// Errors that no smoothing removes, px^2: interpolation of undersampled grains, clipped ones, rounding; measured on
/// evenly moved frames. Averages over blocks of pixels alias what they do not resolve: up to .003 px.
constexpr float systematic_variance(int decimation) { return decimation == 1 ? 0.32e-6f : 3e-6f; }

/// Of these, what interpolation is off by, px, midway between displacements at which pixels meet pixels (there it is
/// nothing); alike in all pairs that move alike. On sand of 3 px grains .0013 without noise and to .0018 with it, on
/// blobs of 4 px .0007 to .0011, from blocks of pixels .0019.
constexpr float interpolation_bias(int decimation) { return decimation == 1 ? 0.0013f : 0.0019f; }

/// A vector's variance when `change` is added to that of the field it was taken from, `own`. A vector that states less
/// than the field (replaced, by what its neighbours scatter) falls by the same share, and never to nothing.
constexpr float changed_variance(float variance, float own, float change) {
  if (change >= 0 || variance >= own) return variance + change;
  return own > 0 && own + change > 0 ? variance * (1 + change / own) : variance;
}

/// Square of what a lattice of this spacing may miss of a field that changes this fast (truncation), from its sixth
/// differences: nothing for waves of ten points, all for jumps. Level pixels.
void truncation_variance(const CellLattice& lattice, const std::vector<float>& u, int threads,
                         std::vector<float>& variance);

/// Largest stated error that a vector of this wide score may have and still be trusted: `most` at a score of 1, by a
/// factor e less for every third less. Where frames do not match, the field is what its neighbours say, and a small
/// stated error then means little. Fitted on maps of displacement, gradient, density, loss and noise.
float trusted_sigma(float most, float wide_score);

}  // namespace pivnp::piv

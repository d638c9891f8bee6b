// Smoothing of a measured field by as much as its own noise allows: shrinkage of local cosine spectra.
#pragma once

#include <cstdint>
#include <vector>

#include "pivnp/piv/dense/spline_field.hpp"

namespace pivnp::piv {

/// One component after smoothing, [ny][nx] of the lattice.
struct SmoothedField {
  std::vector<float> value;
  std::vector<float> variance;  // of what noise is left, and of the signal that was given up with the rest
  std::vector<float> area;      // lattice cells that a value averages over, noise-wise
  std::vector<float> lost;      // square of the bias that is left (lost_variance); empty: not looked for
};

/// Blocks of 8, 16, 32 and 64 points a side, each size at half overlap (sizes that the lattice holds): freed of their
/// plane, transformed (DCT-II), every coefficient multiplied by 1 - strength / P, P its power over the noise's (its own
/// where it stands clear of noise, else the mean of its neighbours'), not below 0; transformed back and averaged with
/// weights that favour blocks of few terms, as noise after smoothing is proportional to them. Waves, bands and kinks
/// above the noise keep their shape; noise elsewhere is averaged over whole blocks. A wave too weak to stand out is
/// taken for noise. The noise's power is that of the block's own fast coefficients (clipped mean, so that structures do
/// not count); its spectrum is that of even white noise seen through hat-weighted cells, (2 + cos kx)(2 + cos ky)/9.
/// Sources: Donoho & Johnstone 1995; Cai 1999 (neighbours); Dabov et al. 2007 (overlapping blocks, weights).
class Shrinker {
 public:
  explicit Shrinker(const CellLattice& lattice);
  /// `wanted`: blocks without any such point are left out, their values pass unchanged (empty: all are wanted).
  /// `caution`: factor on the powers over noise that shrinkage and significance ask for. `risk`: the variance is the
  /// expected square of what shrinkage by these gains is off by, noise and lost signal; else terms next to the
  /// threshold count twelve times, for what is lost below it.
  void run(const std::vector<float>& value, const std::vector<std::uint8_t>& wanted, int threads, SmoothedField& out,
           float caution = 1, bool risk = false) const;

  /// What one block yields.
  struct Block {
    std::vector<float> value;  // [side][side]
    float variance = 0, terms = 0, risk = 0;
    float octave = 1, slow = 1;  // how the noise falls towards long wavelengths, and what that makes of the variance
  };

 private:
  struct Layer {
    int side = 0;
    std::vector<int> x, y;  // where blocks start
    std::vector<float> window;
  };
  CellLattice lattice_;
  std::vector<Layer> layers_;
};

/// Points a lattice needs along each axis: a block of the least size.
inline constexpr int least_lattice_points = 8;

}  // namespace pivnp::piv

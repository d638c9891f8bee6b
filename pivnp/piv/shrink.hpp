// Smoothing of a measured field by as much as its own noise allows: empirical Wiener shrinkage of local cosine spectra.
#pragma once

#include <vector>

#include "pivnp/piv/spline_field.hpp"

namespace pivnp::piv {

/// One component on the lattice, [ny][nx].
struct NoisyField {
  std::vector<float> value;
  std::vector<float> variance;  // of each value's noise
};

/// What was kept of a component.
struct Shrunk {
  std::vector<float> value;
  std::vector<float> variance;  // of the noise that is left
  std::vector<float> removed;   // share of the noise's variance that was removed and so is seen in residuals, 0 ... 1
  std::vector<float> lost;      // square of the signal that may have been shrunk away with it
};

/// Overlapping blocks of up to 16 x 16 points: freed of their plane, transformed (DCT-II), every coefficient multiplied
/// by 1 - strength / (its power over the noise's, averaged over adjacent coefficients; not below 0), transformed back and
/// averaged with weights that favour blocks of few terms. Waves, bands and other structures above the noise stay; noise
/// elsewhere is averaged over up to a block. Noise is taken to be correlated as hat-weighted cells are.
/// Sources: Cai 1999 (block James-Stein), Dabov et al. 2007 (overlapping blocks, weights).
class BlockLayer {
 public:
  BlockLayer(const CellLattice& lattice, int side, int block_step);
  void add(const NoisyField& in, float strength, int threads, Shrunk& out, std::vector<float>& weight) const;

 private:
  CellLattice lattice_;
  int step_;
  int bx_, by_;                         // points of a block
  std::vector<float> dct_x_, dct_y_;    // [frequency][point], orthonormal
  std::vector<float> window_;           // [by][bx]
  std::vector<float> spectrum_;         // [by][bx] of noise of unit variance
};

class Shrinker {
 public:
  explicit Shrinker(const CellLattice& lattice);
  void run(const NoisyField& in, float strength, int threads, Shrunk& out) const;

 private:
  std::vector<BlockLayer> layers_;
};

}  // namespace pivnp::piv

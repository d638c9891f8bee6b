// Illumination that differs between the frames: f = gain g + offset, from the sums of a coarse pass.
#pragma once

#include <vector>

#include "pivnp/piv/dense/normal_sums.hpp"

namespace pivnp::piv {

/// Gain and offset of the second frame's grey values where the frames are matched: those that give both the same mean
/// and standard deviation over five by five cells of the pass they are taken from. Slowly varying over the image.
class IlluminationCorrection {
 public:
  /// `sums` of a pass with scores on a level of `decimation`, in which the second frame was corrected by what is known
  /// so far: the new correction is of the frame as it is. `rounding`: variance of a grey value's rounding, grey^2.
  void take(const CellSums& sums, int decimation, int threads, float rounding);
  void clear() { lattice_ = {}; }
  bool known() const { return lattice_.nx > 0; }
  /// At the points of another level's lattice.
  void at(const CellLattice& lattice, int decimation, int threads, std::vector<float>& gain,
          std::vector<float>& offset) const;

 private:
  CellLattice lattice_;
  int decimation_ = 1;
  std::vector<float> gain_, offset_;
};

}  // namespace pivnp::piv

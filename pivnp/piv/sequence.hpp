// Pairs of one sequence, smoothed with what their neighbours in time know.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "pivnp/piv/piv.hpp"

namespace pivnp::piv {

/// One pair of a camera that moves: where the nodes are, and how what is at rest moves in the image: the pixel (x, y) by
/// (rest[0] + rest[1] x + rest[2] y, rest[3] + rest[4] x + rest[5] y).
struct CameraStep {
  std::vector<std::array<float, 2>> pixel;
  std::array<double, 6> rest{};
};

/// Correlates the pairs of consecutive frames. A pair by itself cannot tell structure below its noise from noise, and
/// smooths it away; particles sum over many pairs, where that bias grows as their number and noise as its root. Here
/// the measured fields of a group of pairs are averaged along the material's paths and shrunk together first, then the
/// halves' and quarters' departures from that, at last each pair's own (docs/theory/piv.md). Methods without a field of
/// their own, and a group of one pair, yield what PairCorrelator yields.
class SequenceCorrelator {
 public:
  /// Pairs that go together. Where vectors must not depend on where a run was taken up again, groups begin at
  /// multiples of it.
  static constexpr int group = 64;
  /// Fewer where the fields of so many pairs would take more than 800 MB (12 megapixels and more, at 8 px from node to
  /// node), 8 at least.
  static int group_for(const PivOptions& options, std::size_t nodes, int width, int height);

  SequenceCorrelator(const PivOptions& options, NodeLattice lattice, int width, int height, int threads);
  ~SequenceCorrelator();
  /// The next pair: its first frame is the second of the pair before. Throws as PairCorrelator::correlate.
  /// `material`: as PairCorrelator::correlate. Pairs are held together all the same.
  /// With a camera that moves, what pairs are held to have in common is their motion against what is at rest.
  void add(const ImageView& first, const ImageView& second, const MaskView& mask, const CameraStep* camera = nullptr,
           const MaskView& material = {});
  int held() const;
  /// Of the pair added last, as its own frames show it.
  const PixelVectors& last() const;
  /// Takes the pair added last off again.
  void drop_last();
  /// The vectors of the pairs held, in order; then none is held.
  std::vector<PixelVectors> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::piv
